//! What tells causes apart: every message has a code, given where it is made.
//!
//! A number stays what it is: it stands in logs, in searches and in the page that `mbs explain` prints
//! (`mbs-cli/pages/`). New causes take the next free number of their group; what is no longer said leaves a gap.

use std::fmt;

macro_rules! codes {
    ($($code:ident = $number:literal,)*) => {
        /// The cause of a message, printed as `MBS0101`.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[repr(u16)]
        pub(crate) enum Code {
            $($code = $number,)*
        }

        impl Code {
            /// All of them, by number.
            pub(crate) const ALL: &[Code] = &[$(Code::$code,)*];
        }
    };
}

codes! {
    // Text, before anything is read in it.
    NotText = 101,
    LineEnds = 102,
    TooLong = 103,
    Unclosed = 104,
    Brackets = 105,
    TooDeep = 106,
    ForeignCharacter = 107,
    QuotedText = 108,

    // Statements and expressions as they are written.
    Unexpected = 201,
    MissingSemicolon = 202,
    NoMechanism = 203,
    OutsideTheMechanism = 204,
    UnknownStatement = 205,
    Documentation = 206,
    Attribute = 207,
    MissingOperator = 208,
    ForeignOperator = 209,
    NumberForm = 210,
    ReservedName = 211,
    NotAName = 212,
    ConditionForm = 213,
    IndexForm = 214,
    RangeForm = 215,
    WrongSign = 216,
    FunctionForm = 217,
    LetForm = 218,
    ForceForm = 219,

    // Files.
    ImportUnreadable = 301,
    ImportCycle = 302,
    ImportOfAMechanism = 303,
    ImportTooLate = 304,
    ImportPath = 305,
    TableForm = 306,
    TableNumber = 307,
    Frozen = 308,
    UnknownRequest = 309,
    Data = 310,

    // Units and the values of declarations.
    MissingUnit = 401,
    UnknownUnit = 402,
    UnitForm = 403,
    MissingValue = 404,
    ValueOfACoordinate = 405,
    QuantityOrProduct = 406,
    UnitOrName = 407,
    QuantityBesideNumbers = 408,
    RadiansAlready = 409,
    OutOfRange = 410,
    GivenInSi = 411,
    OtherThanDeclared = 412,
    NotPositive = 413,
    ArraySize = 414,
    CountOfValues = 415,
    OneNumber = 416,
    KnownAtBuildTime = 417,
    PrescribedByState = 418,
    NotANumber = 419,

    // Names.
    Undeclared = 501,
    DeclaredTwice = 502,
    DeclaredLater = 503,
    DefinedByItself = 504,
    OutOfSight = 505,
    BuiltIn = 506,
    NameClash = 507,
    NotAValue = 508,
    KeepsItsValue = 509,
    ElementGivenAgain = 510,
    ElementWithoutValue = 511,
    NoElements = 512,
    OtherKind = 513,
    Unused = 514,
    ArgumentsAlike = 515,

    // Calls, parts, loops, indices.
    UnknownFunction = 601,
    ArgumentCount = 602,
    Recursion = 603,
    TooMuch = 604,
    NoComponent = 605,
    IndexOutOfRange = 606,
    IndexInALoop = 607,
    IndexWithGaps = 608,
    UnknownPart = 609,
    NotHere = 610,

    // Values: shapes, dimensions, conditions, tables.
    WrongShape = 701,
    NoOperator = 702,
    UnlikeTerms = 703,
    UnequalDimensions = 704,
    WrongDimension = 705,
    NotFinite = 706,
    PowerOfAQuantity = 707,
    ChosenAtBuildTime = 708,
    EqualityInMotion = 709,
    ConditionAsValue = 710,
    BranchShapes = 711,
    MatrixWithoutAxes = 712,
    NoRate = 713,
    TablePlaces = 714,
    TableValues = 715,

    // Energies and forces.
    EnergyDimension = 801,
    EnergyShape = 802,
    InputInEnergy = 803,
    VelocityInPotential = 804,
    NotQuadratic = 805,
    NegativeEnergy = 806,
    NeverFinite = 807,
    ForceDimension = 808,
    ForceTarget = 809,
    ForceShape = 810,
    NoWork = 811,
    GravityShape = 812,
    GravityThatChanges = 813,
    GravityOfHiddenBody = 814,
    GravityOnNothing = 815,
    GravityTwice = 816,
    NeverPositive = 817,
    BringsEnergyIn = 818,
    AngleInDegrees = 819,
    NoDerivative = 820,
    UndefinedAtRest = 821,
    PlaceNoBodyHolds = 822,

    // Bodies, poses, inertia.
    NegativeMass = 901,
    NoMass = 902,
    ImpossibleInertia = 903,
    InertiaNotSymmetric = 904,
    InertiaForm = 905,
    OtherAxes = 906,
    MassThatChanges = 907,
    MovedTwice = 908,
    MassCentreOfTheRoom = 909,
    AxisWithoutDirection = 910,
    AxisThatTurns = 911,
    QuaternionLength = 912,
    PoseThatJumps = 913,
    NoCoordinates = 914,
    NoKineticEnergy = 915,
    NoInertia = 916,
    DependentInertia = 917,
    NeverUsed = 918,
    VectorForAPlace = 919,

    // Constraints.
    SidesOfOneShape = 1001,
    SidesOfOneDimension = 1002,
    InputInConstraint = 1003,
    ConstrainsNothing = 1004,
    ConstraintNotLinear = 1005,
    DependentConstraint = 1006,
    DegenerateConstraint = 1007,
    RateInConstraint = 1008,
    NeverClosed = 1009,

    // Outputs, reactions, shapes.
    OutputShape = 1101,
    JacobianRate = 1102,
    ReactionOfAName = 1103,
    ReactionTooLate = 1104,
    UnknownShape = 1105,
    SizeOfAShape = 1106,
    IdleReaction = 1107,

    // The proof.
    NotProved = 1201,
    TooFewStates = 1202,
    NegativeSomewhere = 1203,
    Overflow = 1204,
    Disagreement = 1205,
    Misprint = 1206,
}

impl fmt::Display for Code {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "MBS{:04}", *self as u16)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_told_apart_and_in_order() {
        assert!(Code::ALL.windows(2).all(|two| two[0] < two[1]), "{:?}", Code::ALL);
        assert_eq!(Code::NotText.to_string(), "MBS0101");
        assert_eq!(Code::Disagreement.to_string(), "MBS1205");
    }
}
