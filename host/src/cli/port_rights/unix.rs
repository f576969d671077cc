//! What Unix keeps with a device.

use rustix::fs::Access;
use std::os::unix::fs::MetadataExt;

/// Whether this user may read from and write to a device.
pub(super) fn may_open(device: &str) -> bool {
    rustix::fs::access(device, Access::READ_OK | Access::WRITE_OK).is_ok()
}

/// The name of the group that a device belongs to.
pub(super) fn group_of(device: &str) -> Option<String> {
    let number = std::fs::metadata(device).ok()?.gid().to_string();
    let groups = std::fs::read_to_string("/etc/group").ok()?;
    let name = |line: &str| {
        let mut fields = line.split(':');
        let name = fields.next()?;
        (fields.nth(1)? == number).then(|| name.to_owned())
    };
    groups.lines().find_map(name)
}
