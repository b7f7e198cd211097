//! How much of a mechanism is proved exactly, in numbers and in a line.

use mbs_derive::verify::Proof;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::words::plural;

/// What is kept of a proof.
#[derive(Serialize, Deserialize)]
pub(crate) struct Evidence {
    identities: usize,
    digits: u32,
    degree: u64,
    points: usize,
    moduli: Vec<u64>,
    in_doubles: Vec<InDoubles>,
}

/// Identities that are proved in doubles alone.
#[derive(Serialize, Deserialize)]
struct InDoubles {
    claim: String,
    identities: usize,
    reason: String,
}

impl Evidence {
    pub(crate) fn of(proof: &Proof) -> Self {
        let evidence = &proof.evidence;
        let in_doubles = evidence.in_doubles.iter().map(|open| InDoubles {
            claim: open.claim.to_string(),
            identities: open.identities,
            reason: open.reason.clone(),
        });
        Evidence {
            identities: evidence.identities,
            digits: evidence.digits,
            degree: evidence.degree,
            points: evidence.points,
            moduli: evidence.moduli.clone(),
            in_doubles: in_doubles.collect(),
        }
    }

    /// Its keys are those of `docs/json.md`.
    pub(crate) fn object(&self) -> Value {
        let in_doubles = self
            .in_doubles
            .iter()
            .map(|open| json!({ "claim": open.claim, "identities": open.identities, "reason": open.reason }));
        json!({
            "exact": self.identities,
            "chance_below": if self.identities == 0 { Value::Null } else { json!(format!("1e-{}", self.digits)) },
            "points": self.points,
            "moduli": self.moduli,
            "degree": self.degree,
            "in_doubles": in_doubles.collect::<Vec<_>>(),
        })
    }

    /// `proved exactly: 31 identities, chance of a false proof below 1e-30; 2 in doubles (output: atan2)`
    pub(crate) fn summary(&self) -> String {
        let exact = (self.identities > 0).then(|| {
            let identities = plural(self.identities, "identity", "identities");
            format!("proved exactly: {identities}, chance of a false proof below 1e-{}", self.digits)
        });
        let count: usize = self.in_doubles.iter().map(|open| open.identities).sum();
        let in_doubles = (count > 0).then(|| format!("{count} in doubles ({})", self.reasons().join(", ")));
        exact.into_iter().chain(in_doubles).collect::<Vec<_>>().join("; ")
    }

    /// One claim is named by each reason, and how many more there are.
    fn reasons(&self) -> Vec<String> {
        let mut reasons: Vec<(&str, Vec<&str>)> = Vec::new();
        for open in &self.in_doubles {
            match reasons.iter_mut().find(|(reason, _)| *reason == open.reason) {
                Some((_, claims)) => claims.push(&open.claim),
                None => reasons.push((&open.reason, vec![&open.claim])),
            }
        }
        let reason = |(reason, claims): &(&str, Vec<&str>)| match claims.len() {
            1 => format!("{}: {reason}", claims[0]),
            count => format!("{} and {} more: {reason}", claims[0], count - 1),
        };
        reasons.iter().map(reason).collect()
    }

    /// Points, fields and degrees, and each claim that is proved in doubles alone.
    pub(crate) fn details(&self) -> String {
        let moduli: Vec<String> = self.moduli.iter().map(u64::to_string).collect();
        let mut lines = format!(
            "  {}, one in each field of {} elements; degrees up to {}\n",
            plural(self.points, "point", "points"),
            moduli.join(", "),
            self.degree,
        );
        for open in &self.in_doubles {
            let identities = plural(open.identities, "identity", "identities");
            lines += &format!("  in doubles: {}, {identities}: {}\n", open.claim, open.reason);
        }
        lines
    }
}
