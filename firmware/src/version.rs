//! Which firmware this is, as hello says it: version and commit, fixed when it is built.

/// This crate's version: major, minor, patch.
pub(crate) const FIRMWARE_VERSION: [u8; 3] = [
    digits(env!("CARGO_PKG_VERSION_MAJOR")),
    digits(env!("CARGO_PKG_VERSION_MINOR")),
    digits(env!("CARGO_PKG_VERSION_PATCH")),
];

/// The commit that this firmware was built from, as `firmware/build` hands it over; 0 if it does not.
pub(crate) const FIRMWARE_GIT: u32 = match option_env!("WMR_GIT") {
    Some(text) => hexadecimal(text),
    None => 0,
};

/// The number that the first eight hexadecimal digits of `text` stand for.
const fn hexadecimal(text: &str) -> u32 {
    let mut bytes = text.as_bytes();
    let mut value = 0;
    let mut taken = 0;
    while let [digit, rest @ ..] = bytes {
        let digit = match *digit {
            digit @ b'0'..=b'9' => digit - b'0',
            digit @ b'a'..=b'f' => digit - b'a' + 10,
            _ => return value,
        };
        if taken == 8 {
            return value;
        }
        value = value << 4 | digit as u32;
        taken += 1;
        bytes = rest;
    }
    value
}

const fn digits(text: &str) -> u8 {
    let mut bytes = text.as_bytes();
    let mut value = 0;
    while let [digit, rest @ ..] = bytes {
        value = value * 10 + (*digit - b'0');
        bytes = rest;
    }
    value
}
