//! The robot without a board: bytes, encoder counts and elapsed time in, motor duty and bytes out.
#![cfg_attr(not(test), no_std)]
#![warn(clippy::indexing_slicing)]
