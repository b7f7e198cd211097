//! Parameters that a mechanism cannot have are refused, by name, value and condition; those that were declared are not.

use mbs_runtime::{ParameterCondition, ParameterError};
use mbs_tests::mechanisms::charged_particle::{ChargedParticle, Params};

macro_rules! defaults_are_accepted {
    ($($module:ident $name:ident $dof:literal $inputs:literal $rows:literal;)*) => {
        $(
            assert_eq!(mbs_models::$module::Params::<f64>::default().check(), Ok(()), stringify!($name));
            assert_eq!(mbs_models::$module::Params::<f32>::default().check(), Ok(()), stringify!($name));
            assert!(mbs_models::$module::$name::<f64>::try_new(Default::default()).is_ok());
        )*
    };
}

#[test]
fn defaults() {
    mbs_models::for_each_mechanism!(defaults_are_accepted);
}

#[test]
fn masses_and_lengths() {
    use mbs_models::{arm6_params, cart_pole};
    let refused = |params: cart_pole::Params| cart_pole::CartPole::try_new(params).unwrap_err();
    let default = cart_pole::Params::default();
    let error = refused(cart_pole::Params { m_bob: -0.1, ..default });
    let expected = ParameterError::new("m_bob", -0.1, ParameterCondition::NotNegative);
    assert_eq!(error, expected);
    assert_eq!(error.to_string(), "`m_bob` must not be negative, it is -0.1");
    let error = refused(cart_pole::Params { length: -0.5, ..default });
    assert_eq!((error.quantity, error.condition), ("length", ParameterCondition::Positive));
    let error = refused(cart_pole::Params { b: f64::NAN, ..default });
    assert_eq!((error.quantity, error.condition), ("b", ParameterCondition::Finite));
    // `new` does not check.
    assert!(cart_pole::CartPole::new(cart_pole::Params { m_bob: -0.1, ..default }).params().m_bob < 0.0);

    let mut arm = arm6_params::Params::<f64>::default();
    assert_eq!(arm.check(), Ok(()));
    arm.mass[3] = -1.0;
    assert_eq!(arm.check().unwrap_err().quantity, "mass_3");
    let mut arm = arm6_params::Params::<f64>::default();
    arm.i_xx[2] = 100.0;
    let error = arm.check().unwrap_err();
    assert!(error.quantity.contains("i_xx_2") && error.condition == ParameterCondition::InertiaOfABody, "{error}");
}

#[test]
fn json() {
    let read = |text: &str| serde_json::from_str::<Params>(text);
    let written = serde_json::to_string(&Params::<f64>::default()).unwrap();
    assert_eq!(read(&written).unwrap(), Params::default());
    assert_eq!(read(r#"{"m": 2}"#).unwrap(), Params { m: 2.0, ..Params::default() });
    assert!(ChargedParticle::try_new(read("{}").unwrap()).is_ok());
    let error = read(r#"{"m": -2}"#).unwrap_err().to_string();
    assert!(error.starts_with("`m` must not be negative, it is -2.0"), "{error}");
    assert!(read(r#"{"mass": 2}"#).unwrap_err().to_string().contains("unknown field `mass`"));
}
