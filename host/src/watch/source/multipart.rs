//! The bytes of an HTTP answer and of the parts in a stream of pictures (`multipart/x-mixed-replace`).
//!
//! A part is as long as its `Content-Length` says, or ends before the next boundary.

use super::LARGEST_FRAME;
use std::io::{self, Read};

/// Heads of answers and parts are shorter than this, bytes.
const LARGEST_HEAD: usize = 16 << 10;

const LINE_END: &[u8] = b"\r\n";

/// A reader that can look ahead for a mark.
#[derive(Debug)]
pub(super) struct Buffered<R> {
    reader: R,
    bytes: Vec<u8>,
    /// From here on nothing is used yet.
    at: usize,
}

/// What a part says of itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct PartHead {
    pub(super) length: Option<usize>,
    /// `X-Timestamp`, as mjpg-streamer sends it: seconds since 1970.
    pub(super) timestamp: Option<String>,
}

impl<R: Read> Buffered<R> {
    pub(super) fn new(reader: R) -> Self {
        Self { reader, bytes: Vec::new(), at: 0 }
    }

    /// All that follows up to the next `mark`, which is passed over.
    pub(super) fn until(&mut self, mark: &[u8], most: usize) -> io::Result<Vec<u8>> {
        let mut from = 0;
        loop {
            let rest = &self.bytes[self.at..];
            if let Some(place) = rest[from..].windows(mark.len()).position(|is| is == mark) {
                let found = rest[..from + place].to_vec();
                self.at += from + place + mark.len();
                return Ok(found);
            }
            if rest.len() > most {
                return Err(io::Error::new(io::ErrorKind::InvalidData, "a part has no end"));
            }
            from = rest.len().saturating_sub(mark.len() - 1);
            self.fill()?;
        }
    }

    /// So many bytes.
    pub(super) fn exactly(&mut self, length: usize) -> io::Result<Vec<u8>> {
        while self.bytes.len() - self.at < length {
            self.fill()?;
        }
        let taken = self.bytes[self.at..self.at + length].to_vec();
        self.at += length;
        Ok(taken)
    }

    /// All that follows until the other end closes.
    pub(super) fn read_rest(&mut self) -> io::Result<Vec<u8>> {
        loop {
            match self.fill() {
                Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
                    let rest = self.bytes.split_off(self.at);
                    self.at = self.bytes.len();
                    return Ok(rest);
                }
                Err(error) => return Err(error),
                Ok(()) if self.bytes.len() - self.at > LARGEST_FRAME => {
                    return Err(io::Error::new(io::ErrorKind::InvalidData, "it has no end"));
                }
                Ok(()) => {}
            }
        }
    }

    /// The head of an answer or part: all up to an empty line.
    pub(super) fn head(&mut self) -> io::Result<Vec<u8>> {
        let mut head = self.until(b"\r\n\r\n", LARGEST_HEAD)?;
        head.extend(b"\r\n\r\n");
        Ok(head)
    }

    /// The head of the next part behind `boundary`.
    pub(super) fn next_part(&mut self, boundary: &[u8]) -> io::Result<PartHead> {
        self.until(boundary, LARGEST_FRAME)?;
        // The rest of the boundary's line; two dashes there end the stream.
        if self.until(LINE_END, LARGEST_HEAD)?.starts_with(b"--") {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        // That line's end is the empty line too where the part says nothing of itself.
        self.at -= LINE_END.len();
        let head = self.head()?;
        let mut headers = [httparse::EMPTY_HEADER; 32];
        let lines = head.strip_prefix(LINE_END).unwrap_or(&head);
        let parsed = httparse::parse_headers(lines, &mut headers)
            .map_err(|error| io::Error::new(io::ErrorKind::InvalidData, error))?;
        let found = match parsed {
            httparse::Status::Complete((_, headers)) => headers,
            httparse::Status::Partial => return Err(io::ErrorKind::InvalidData.into()),
        };
        let text = |name: &str| header(found, name);
        Ok(PartHead {
            length: text("Content-Length").and_then(|length| length.trim().parse().ok()),
            timestamp: text("X-Timestamp"),
        })
    }

    /// The picture of the part with this head.
    pub(super) fn picture(&mut self, head: &PartHead, boundary: &[u8]) -> io::Result<Vec<u8>> {
        match head.length {
            Some(length) if length > LARGEST_FRAME => {
                Err(io::Error::new(io::ErrorKind::FileTooLarge, "a frame is too large"))
            }
            Some(length) => self.exactly(length),
            None => {
                let mut picture = self.until(boundary, LARGEST_FRAME)?;
                // The next part begins at this boundary, which may have more dashes.
                self.at -= boundary.len();
                while picture.last() == Some(&b'-') {
                    picture.pop();
                }
                picture.truncate(picture.strip_suffix(b"\r\n").map_or(picture.len(), <[u8]>::len));
                Ok(picture)
            }
        }
    }

    fn fill(&mut self) -> io::Result<()> {
        self.bytes.drain(..self.at);
        self.at = 0;
        let mut chunk = [0; 16 << 10];
        let length = self.reader.read(&mut chunk)?;
        if length == 0 {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        self.bytes.extend_from_slice(&chunk[..length]);
        Ok(())
    }
}

/// The value of a header.
pub(super) fn header(headers: &[httparse::Header<'_>], name: &str) -> Option<String> {
    let found = headers.iter().find(|header| header.name.eq_ignore_ascii_case(name))?;
    Some(String::from_utf8_lossy(found.value).into_owned())
}

/// The mark before each part that a content type names, with its two dashes; `None` if it is no stream.
pub(super) fn boundary(content: &str) -> Option<Vec<u8>> {
    let mut parts = content.split(';').map(str::trim);
    let kind = parts.next()?;
    if !kind.to_ascii_lowercase().starts_with("multipart/") {
        return None;
    }
    let value = parts.find_map(|part| {
        let (name, value) = part.split_once('=')?;
        name.trim().eq_ignore_ascii_case("boundary").then(|| value.trim().trim_matches('"'))
    })?;
    // Some cameras write the dashes into the name already.
    let name = value.trim_start_matches('-');
    (!name.is_empty()).then(|| format!("--{name}").into_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives its bytes a few at a time.
    struct Dripping<'a>(&'a [u8], usize);

    impl Read for Dripping<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let length = self.1.min(self.0.len()).min(buffer.len());
            buffer[..length].copy_from_slice(&self.0[..length]);
            self.0 = &self.0[length..];
            Ok(length)
        }
    }

    const STREAM: &[u8] = b"--cut\r\nContent-Type: image/jpeg\r\nContent-Length: 4\r\nX-Timestamp: 12.5\r\n\r\nab\r\n\r\n--cut\r\nContent-Type: image/jpeg\r\n\r\nlonger--cu\r\n--cut--\r\n";

    #[test]
    fn parts_are_taken_apart_however_they_arrive() {
        let mark = boundary("multipart/x-mixed-replace; boundary=\"--cut\"").unwrap();
        for step in [1, 2, 3, 7, 1000] {
            let mut stream = Buffered::new(Dripping(STREAM, step));
            let head = stream.next_part(&mark).unwrap();
            assert_eq!(head, PartHead { length: Some(4), timestamp: Some("12.5".into()) });
            assert_eq!(stream.picture(&head, &mark).unwrap(), b"ab\r\n");
            let head = stream.next_part(&mark).unwrap();
            assert_eq!(head, PartHead::default());
            assert_eq!(stream.picture(&head, &mark).unwrap(), b"longer--cu");
            assert!(stream.next_part(&mark).is_err(), "the end");
        }
    }

    #[test]
    fn boundaries_are_named_in_many_ways() {
        let named = |content| boundary(content).map(|mark| String::from_utf8(mark).unwrap());
        assert_eq!(named("multipart/x-mixed-replace;boundary=--frame").as_deref(), Some("--frame"));
        assert_eq!(
            named("Multipart/X-Mixed-Replace; charset=x; Boundary=a=b").as_deref(),
            Some("--a=b")
        );
        assert_eq!(named("image/jpeg"), None);
        assert_eq!(named("multipart/x-mixed-replace"), None);
    }

    #[test]
    fn what_has_no_end_is_given_up() {
        let endless = vec![b'x'; 64 << 10];
        let mut stream = Buffered::new(Dripping(&endless, 4096));
        assert_eq!(stream.head().unwrap_err().kind(), io::ErrorKind::InvalidData);
    }
}
