//! What stands in the files of a new crate: `templates/`, with names put in.

/// A mechanism to begin with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Template {
    /// A bob on a rod, with friction and a motor.
    Pendulum,
    /// Three links from a table, under a controller that knows gravity.
    Arm,
    /// A four-bar linkage: a loop, closed by a constraint.
    Linkage,
    /// A car whose wheels do not slip: constraints on velocities.
    Vehicle,
    /// Two bodies that attract each other.
    Orbit,
    /// A thousand pendulums with random parameters, on all cores.
    Ensemble,
}

impl Template {
    /// What it is called, and its mechanism's file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Template::Pendulum => "pendulum",
            Template::Arm => "arm",
            Template::Linkage => "linkage",
            Template::Vehicle => "vehicle",
            Template::Orbit => "orbit",
            Template::Ensemble => "ensemble",
        }
    }

    /// The mechanism's text.
    pub(super) fn mechanism(self) -> &'static str {
        match self {
            Template::Pendulum => include_str!("../../templates/pendulum/pendulum.mbs"),
            Template::Arm => include_str!("../../templates/arm/arm.mbs"),
            Template::Linkage => include_str!("../../templates/linkage/linkage.mbs"),
            Template::Vehicle => include_str!("../../templates/vehicle/vehicle.mbs"),
            Template::Orbit => include_str!("../../templates/orbit/orbit.mbs"),
            Template::Ensemble => include_str!("../../templates/ensemble/ensemble.mbs"),
        }
    }

    /// Another file of its folder `mechanisms/`, by its path.
    pub(super) fn beside(self, name: &str) -> Option<&'static str> {
        let links = "mechanisms/links.csv";
        (self == Template::Arm && name == links).then_some(include_str!("../../templates/arm/links.csv"))
    }

    fn program(self) -> &'static str {
        match self {
            Template::Pendulum => include_str!("../../templates/pendulum/main.rs"),
            Template::Arm => include_str!("../../templates/arm/main.rs"),
            Template::Linkage => include_str!("../../templates/linkage/main.rs"),
            Template::Vehicle => include_str!("../../templates/vehicle/main.rs"),
            Template::Orbit => include_str!("../../templates/orbit/main.rs"),
            Template::Ensemble => include_str!("../../templates/ensemble/main.rs"),
        }
    }

    /// Path and text of each file, but for the snapshot; `dependency` is a package's line in the manifest.
    pub(super) fn files(self, name: &str, dependency: impl Fn(&str) -> String) -> Vec<(String, String)> {
        let rayon = if self == Template::Ensemble { "rayon = \"1.12.0\"\n" } else { "" };
        let filled = |text: &str| {
            text.replace("{{name}}", name)
                .replace("{{mechanism}}", self.name())
                .replace("{{dependencies}}", &(dependency("mbs-runtime") + rayon))
                .replace("{{mbs-derive}}\n[", &(dependency("mbs-derive") + "\n["))
                .replace("{{mbs-derive}}", &dependency("mbs-derive"))
        };
        let mechanism = format!("mechanisms/{}.mbs", self.name());
        let mut files = vec![
            ("Cargo.toml".to_string(), filled(include_str!("../../templates/Cargo.toml.txt"))),
            ("build.rs".to_string(), filled(include_str!("../../templates/build.rs.txt"))),
            (".gitignore".to_string(), "/target\n/*.csv\n/*.svg\n".to_string()),
            (mechanism, self.mechanism().to_string()),
            ("src/main.rs".to_string(), self.program().to_string()),
            ("src/picture.rs".to_string(), include_str!("../../templates/picture.rs.txt").to_string()),
            ("tests/review.rs".to_string(), filled(include_str!("../../templates/review.rs.txt"))),
        ];
        if let Some(table) = self.beside("mechanisms/links.csv") {
            files.push(("mechanisms/links.csv".to_string(), table.to_string()));
        }
        files
    }
}
