//! How a [`ResultPart`] is read: its name is one of those that functions give their parts.

use serde::de::Error;
use serde::{Deserialize, Deserializer};

use super::{ResultPart, Shape};

const NAMES: [&str; 4] = ["", "q", "qd", "u"];

#[derive(Deserialize)]
struct Written {
    name: String,
    shape: Shape,
}

impl<'de> Deserialize<'de> for ResultPart {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let Written { name, shape } = Written::deserialize(deserializer)?;
        match NAMES.into_iter().find(|known| *known == name) {
            Some(name) => Ok(ResultPart { name, shape }),
            None => Err(D::Error::custom(format_args!("no function returns a part `{name}`"))),
        }
    }
}
