//! End-to-end tests of wmr; this library holds what they share.
