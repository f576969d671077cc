//! The `wmr` command line.

fn main() {}
