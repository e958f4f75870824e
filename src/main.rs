//! burnish
fn main() {}
