//! Where frames come from: a folder that fills, or a camera behind a URL.
//!
//! A source waits and reads; it does so on a thread of its own ([`Background`]), which keeps only the newest
//! frame. Times are the computer's ([`Instant`]); a frame's exposure is as good as the source knows it.

mod background;
mod folder;
mod http;
mod multipart;

pub use background::Background;
pub use folder::FolderSource;
pub use http::HttpSource;

use std::io;
use std::path::Path;
use std::time::{Duration, Instant};

/// The largest frame that is taken in: an uncompressed picture of 10 megapixels.
pub const LARGEST_FRAME: usize = 32 << 20;

/// A picture file as it came.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RawFrame {
    /// When it was exposed, as well as the source knows.
    pub exposed: Instant,
    /// When this computer had it.
    pub delivered: Instant,
    /// PNG, JPEG or another format that `wmr` reads.
    pub bytes: Vec<u8>,
}

/// Something that delivers frames.
pub trait FrameSource: Send {
    /// The newest frame since the last call; `None` if there is none for now. Waits for half a second at
    /// most.
    ///
    /// # Errors
    /// [`SourceError`]; one that is not [lasting](SourceError::is_lasting) may pass, so the source is to be
    /// asked again.
    fn next(&mut self) -> Result<Option<RawFrame>, SourceError>;
}

/// Why a source delivers nothing.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum SourceError {
    /// The name is neither a folder nor a URL.
    #[error("{0} is no source of frames")]
    #[diagnostic(help("give a folder that fills, http://HOST:PORT/PATH, or sim"))]
    Unknown(String),
    /// A device of the kernel's video interface.
    #[error("{0} is a video device, which wmr does not read itself")]
    #[diagnostic(help(
        "let ustreamer or mjpg-streamer offer it as http://127.0.0.1:8080/stream, or ffmpeg write its frames into a folder: ffmpeg -i {0} -r 10 DIR/%06d.jpg"
    ))]
    Device(String),
    /// The URL asks for encryption.
    #[error("{0} is encrypted, which wmr does not speak")]
    #[diagnostic(help("use http:// inside your own network"))]
    Encrypted(String),
    /// The URL cannot be taken apart.
    #[error("{0} is no address")]
    #[diagnostic(help("write it as http://HOST:PORT/PATH, without a user's name"))]
    Address(String),
    /// The folder or connection fails.
    #[error("{name}: {error}")]
    #[diagnostic(help("look whether the camera is on and sends"))]
    Io {
        /// Folder or URL.
        name: String,
        /// What the system says.
        error: io::Error,
    },
    /// The server answers with something else than a picture.
    #[error("{name} answers {status}")]
    #[diagnostic(help("open it in a browser to see what it is"))]
    Status {
        /// The URL.
        name: String,
        /// Status and reason.
        status: String,
    },
    /// The server's content is neither a picture nor a stream of pictures.
    #[error("{name} sends {content}, not image/* or multipart/x-mixed-replace")]
    #[diagnostic(help("give the address of the stream itself"))]
    Content {
        /// The URL.
        name: String,
        /// The content type.
        content: String,
    },
    /// What arrives is not what the protocol says.
    #[error("{name} sends what is no HTTP: {what}")]
    #[diagnostic(help("give the address of a camera"))]
    Malformed {
        /// The URL.
        name: String,
        /// What is wrong.
        what: String,
    },
    /// A frame is too large.
    #[error("{name}: a frame has more than {} MB", LARGEST_FRAME >> 20)]
    #[diagnostic(help("lower the camera's resolution"))]
    TooLarge {
        /// Folder or URL.
        name: String,
    },
    /// Frames come faster than anything can use them.
    #[error("{frames} frames with {megabytes} MB came within a second")]
    #[diagnostic(help("lower the camera's frame rate"))]
    Flood {
        /// How many.
        frames: u32,
        /// How much, 10⁶ bytes.
        megabytes: u64,
    },
    /// There was no frame.
    #[error("no frame came within {:.0} s", .0.as_secs_f64())]
    #[diagnostic(help("look whether the camera is on and sends"))]
    Silent(Duration),
}

impl SourceError {
    /// Whether asking again is of no use.
    pub fn is_lasting(&self) -> bool {
        !matches!(self, Self::Io { .. } | Self::Silent(_))
    }
}

/// Opens the source of that name: a folder, or an `http://` URL.
///
/// # Errors
/// [`SourceError`] if it is neither.
///
/// ```
/// use wmr::watch::source::{SourceError, open};
/// assert!(matches!(open("https://camera/"), Err(SourceError::Encrypted(_))));
/// assert!(matches!(open("no such folder"), Err(SourceError::Unknown(_))));
/// ```
pub fn open(name: &str) -> Result<Box<dyn FrameSource>, SourceError> {
    if name.starts_with("https://") {
        return Err(SourceError::Encrypted(name.into()));
    }
    if name.starts_with("http://") {
        return Ok(Box::new(HttpSource::new(name)?));
    }
    if name.starts_with("/dev/") {
        return Err(SourceError::Device(name.into()));
    }
    let path = Path::new(name);
    if path.is_dir() {
        return Ok(Box::new(FolderSource::new(path)));
    }
    Err(SourceError::Unknown(name.into()))
}
