//! A base that exists only in software: motors, wheels, encoders, wires and virtual time.
