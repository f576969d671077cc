//! Whether this user may open a device, and which group's members may.

#[cfg(unix)]
mod unix;
#[cfg(not(unix))]
mod without;

#[cfg(unix)]
use unix::{group_of, may_open};
#[cfg(not(unix))]
use without::{group_of, may_open};

/// Who may open serial ports on most Linux systems.
const USUAL_GROUP: &str = "dialout";

/// What to type to be let in, if this user may not open a device.
pub(crate) fn refused(device: &str) -> Option<String> {
    (!may_open(device)).then(|| join_group(device))
}

/// What lets this user open a device: the group that it belongs to.
pub(crate) fn join_group(device: &str) -> String {
    let group = group_of(device).unwrap_or_else(|| USUAL_GROUP.to_owned());
    format!("sudo usermod -aG {group} $USER, then log out and in")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_of_one_s_own_may_be_opened_and_an_unknown_device_belongs_to_the_usual_group() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert_eq!(refused(file.path().to_str().unwrap()), None);
        assert!(join_group("/dev/no-such-port").contains("-aG dialout "));
    }
}
