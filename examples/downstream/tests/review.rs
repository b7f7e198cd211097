//! What is generated for the crane, as it is reviewed: `cargo insta review` shows what a change of its energies did.

#[test]
fn crane() {
    insta::assert_snapshot!(mbs_derive::review("mechanisms/crane.mbs").unwrap());
}
