//! A folder into which somebody writes picture after picture.
//!
//! Files are taken in the order of their modification times, equal ones by name, and only the newest whole one
//! counts: a file that is still being written is looked at again. The time of modification stands for that of
//! the exposure.

use super::{FrameSource, LARGEST_FRAME, RawFrame, SourceError};
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// What pictures' names end with.
const ENDINGS: [&str; 9] = ["png", "jpg", "jpeg", "bmp", "ppm", "pgm", "pnm", "tif", "tiff"];
/// The folder is looked at this often at most.
const INTERVAL: Duration = Duration::from_millis(10);
/// A file of a format without an end mark counts as whole when nobody has written to it for so long.
const SETTLED: Duration = Duration::from_millis(200);

/// Frames out of a folder.
#[derive(Clone, Debug)]
pub struct FolderSource {
    path: PathBuf,
    /// The last file that was taken.
    last: Option<(SystemTime, OsString)>,
}

impl FolderSource {
    /// Frames out of the folder `path`; the first is the newest that is there already.
    pub fn new(path: &Path) -> Self {
        Self { path: path.to_owned(), last: None }
    }

    fn failed(&self, error: io::Error) -> SourceError {
        SourceError::Io { name: self.path.display().to_string(), error }
    }

    /// The files that are newer than the last one taken, newest first.
    fn newer(&self) -> io::Result<Vec<(SystemTime, OsString)>> {
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.path)? {
            let entry = entry?;
            let name = entry.file_name();
            if !is_picture(&name) {
                continue;
            }
            // A file that is gone meanwhile is none.
            let Ok(modified) = entry.metadata().and_then(|data| data.modified()) else { continue };
            let key = (modified, name);
            if self.last.as_ref().is_none_or(|last| *last < key) {
                files.push(key);
            }
        }
        files.sort_unstable_by(|a, b| b.cmp(a));
        Ok(files)
    }
}

impl FrameSource for FolderSource {
    fn next(&mut self) -> Result<Option<RawFrame>, SourceError> {
        let began = Instant::now();
        let files = self.newer().map_err(|error| self.failed(error))?;
        for (modified, name) in files {
            // It may have been taken away again.
            let Ok(bytes) = read(&self.path.join(&name)) else { continue };
            if bytes.len() > LARGEST_FRAME {
                return Err(SourceError::TooLarge {
                    name: self.path.join(&name).display().to_string(),
                });
            }
            let delivered = Instant::now();
            let age = SystemTime::now().duration_since(modified).unwrap_or_default();
            if is_whole(&bytes, age) {
                let exposed = delivered.checked_sub(age).unwrap_or(delivered);
                self.last = Some((modified, name));
                return Ok(Some(RawFrame { exposed, delivered, bytes }));
            }
        }
        // A folder of very many files takes long to look through: that must not be all that is done.
        std::thread::sleep(INTERVAL.max(2 * began.elapsed()));
        Ok(None)
    }
}

fn read(path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(LARGEST_FRAME as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

fn is_picture(name: &OsString) -> bool {
    let path = Path::new(name);
    let hidden = name.to_string_lossy().starts_with('.');
    let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or_default();
    !hidden && ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known))
}

/// Whether the file that was written to `age` ago has its end: JPEG and PNG say where it is.
fn is_whole(bytes: &[u8], age: Duration) -> bool {
    if bytes.starts_with(&[0xff, 0xd8]) {
        let padding = bytes.iter().rev().take_while(|byte| **byte == 0).count();
        return bytes[..bytes.len() - padding].ends_with(&[0xff, 0xd9]);
    }
    if bytes.starts_with(b"\x89PNG") {
        return bytes.windows(4).rev().take(64).any(|chunk| chunk == b"IEND");
    }
    !bytes.is_empty() && age >= SETTLED
}

#[cfg(test)]
mod tests {
    use super::*;

    const JPEG: [u8; 5] = [0xff, 0xd8, 7, 0xff, 0xd9];

    /// Writes a file that was last modified so many milliseconds after the epoch.
    fn write(folder: &Path, name: &str, bytes: &[u8], at: u64) {
        fs::write(folder.join(name), bytes).unwrap();
        let file = File::options().append(true).open(folder.join(name)).unwrap();
        file.set_modified(SystemTime::UNIX_EPOCH + Duration::from_millis(at)).unwrap();
    }

    #[test]
    fn the_newest_whole_file_counts_and_each_once() {
        let folder = tempfile::tempdir().unwrap();
        let mut source = FolderSource::new(folder.path());
        assert_eq!(source.next().unwrap(), None);
        write(folder.path(), "b.jpg", &[JPEG.as_slice(), &[0]].concat(), 1000);
        write(folder.path(), "a.jpg", &JPEG, 1000);
        write(folder.path(), ".c.jpg", &JPEG, 9000);
        write(folder.path(), "notes.txt", &JPEG, 9000);
        assert_eq!(source.next().unwrap().unwrap().bytes.len(), 6, "equal times go by name");
        assert_eq!(source.next().unwrap(), None, "a.jpg is older");
        // Half written, then whole.
        write(folder.path(), "d.jpg", &JPEG[..3], 2000);
        assert_eq!(source.next().unwrap(), None);
        write(folder.path(), "d.jpg", &JPEG, 2001);
        assert_eq!(source.next().unwrap().unwrap().bytes, JPEG);
        // The same name, written again.
        write(folder.path(), "d.jpg", &JPEG, 2002);
        assert!(source.next().unwrap().is_some());
    }

    #[test]
    fn the_exposure_is_as_old_as_the_file() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("a.jpg"), JPEG).unwrap();
        let file = File::options().append(true).open(folder.path().join("a.jpg")).unwrap();
        file.set_modified(SystemTime::now() - Duration::from_secs(7)).unwrap();
        let frame = FolderSource::new(folder.path()).next().unwrap().unwrap();
        let age = frame.delivered - frame.exposed;
        assert!((7.0..9.0).contains(&age.as_secs_f64()), "{age:?}");
    }

    #[test]
    fn ends_are_found() {
        let old = Duration::from_secs(1);
        assert!(is_whole(b"\x89PNG....IEND\xae\x42\x60\x82", Duration::ZERO));
        assert!(!is_whole(b"\x89PNG....IDAT", old));
        assert!(is_whole(b"P6 1 1 255 abc", old) && !is_whole(b"P6 1 1 255 abc", Duration::ZERO));
        assert!(!is_whole(b"", old));
    }

    #[test]
    fn a_folder_that_is_gone_is_an_error() {
        let folder = tempfile::tempdir().unwrap();
        let mut source = FolderSource::new(&folder.path().join("gone"));
        assert!(matches!(source.next(), Err(SourceError::Io { .. })));
    }
}
