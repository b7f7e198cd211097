fn main() {
    mbs_derive::compile("mechanisms/crane.mbs");
}
