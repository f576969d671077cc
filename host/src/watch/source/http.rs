//! A camera that speaks HTTP: a stream of pictures (MJPEG), or one picture for each request.
//!
//! Requests are of HTTP 1.0, so that answers come in one piece and end with the connection. A stream is read
//! as fast as it comes, so that frames do not grow old in between. The time of
//! a frame is that of its head's arrival; where the part tells its own time by this computer's clock, as
//! mjpg-streamer does (`X-Timestamp`), that one. Of single pictures it is the middle between request and answer.

use super::multipart::{Buffered, PartHead, boundary, header};
use super::{FrameSource, LARGEST_FRAME, RawFrame, SourceError};
use std::io::{self, ErrorKind, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant, SystemTime};

/// Connecting, and each wait for more bytes, takes no longer.
const TIMEOUT: Duration = Duration::from_millis(500);
/// A stream that is silent for so long is opened again.
const PATIENCE: Duration = Duration::from_secs(3);
/// Single pictures are asked for this often at most.
const INTERVAL: Duration = Duration::from_millis(40);
/// A part's own time is believed if it lies so long before its arrival at most.
const OLDEST_STAMP: f64 = 2.0;

/// Frames from a URL.
#[derive(Debug)]
pub struct HttpSource {
    name: String,
    /// `HOST:PORT`.
    address: String,
    path: String,
    stream: Option<Stream>,
    asked: Option<Instant>,
}

/// A stream that is being read.
#[derive(Debug)]
struct Stream {
    bytes: Buffered<TcpStream>,
    boundary: Vec<u8>,
    heard: Instant,
}

/// What a server answers with.
enum Answer {
    Stream(Stream),
    Picture(RawFrame),
}

impl HttpSource {
    /// The camera at `http://HOST[:PORT]/PATH`; nothing is sent yet.
    ///
    /// # Errors
    /// [`SourceError::Address`] if that is none.
    pub fn new(url: &str) -> Result<Self, SourceError> {
        let wrong = || SourceError::Address(url.into());
        let rest = url.strip_prefix("http://").ok_or_else(wrong)?;
        let (host, path) = match rest.find(['/', '?']) {
            Some(place) => rest.split_at(place),
            None => (rest, ""),
        };
        let is_clean = |text: &str| text.chars().all(|letter| letter.is_ascii_graphic());
        if host.is_empty() || host.contains('@') || !is_clean(rest) {
            return Err(wrong());
        }
        let has_port = host.rsplit_once(':').is_some_and(|(_, port)| port.parse::<u16>().is_ok());
        let address = if has_port { host.into() } else { format!("{host}:80") };
        let path = if path.starts_with('/') { path.into() } else { format!("/{path}") };
        Ok(Self { name: url.into(), address, path, stream: None, asked: None })
    }

    fn failed(&self, error: io::Error) -> SourceError {
        let name = self.name.clone();
        match error.kind() {
            ErrorKind::FileTooLarge => SourceError::TooLarge { name },
            ErrorKind::InvalidData => SourceError::Malformed { name, what: error.to_string() },
            ErrorKind::UnexpectedEof => {
                let error = io::Error::new(error.kind(), "the connection was closed");
                SourceError::Io { name, error }
            }
            _ => SourceError::Io { name, error },
        }
    }

    fn connect(&self) -> io::Result<TcpStream> {
        let mut last = io::Error::new(ErrorKind::NotFound, "the name has no address");
        for address in self.address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, TIMEOUT) {
                Ok(stream) => {
                    stream.set_read_timeout(Some(TIMEOUT))?;
                    stream.set_write_timeout(Some(TIMEOUT))?;
                    return Ok(stream);
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Asks the server, and reads the head of its answer.
    fn ask(&self) -> Result<Answer, SourceError> {
        let asked = Instant::now();
        let failed = |error| self.failed(error);
        let mut stream = self.connect().map_err(failed)?;
        let Self { path, address, .. } = self;
        let request = format!(
            "GET {path} HTTP/1.0\r\nHost: {address}\r\nAccept: image/*, multipart/*\r\n\r\n"
        );
        stream.write_all(request.as_bytes()).map_err(failed)?;
        let mut bytes = Buffered::new(stream);
        let head = bytes.head().map_err(failed)?;
        let answered = Instant::now();
        let (content, length) = self.check_head(&head)?;
        if let Some(boundary) = boundary(&content) {
            return Ok(Answer::Stream(Stream { bytes, boundary, heard: answered }));
        }
        if !content.to_ascii_lowercase().starts_with("image/") {
            return Err(SourceError::Content { name: self.name.clone(), content });
        }
        let picture = match length {
            Some(length) if length > LARGEST_FRAME => {
                return Err(SourceError::TooLarge { name: self.name.clone() });
            }
            Some(length) => bytes.exactly(length),
            None => bytes.read_rest(),
        };
        let exposed = asked + (answered - asked) / 2;
        let bytes = picture.map_err(failed)?;
        Ok(Answer::Picture(RawFrame { exposed, delivered: Instant::now(), bytes }))
    }

    /// Content type and length of an answer, if it is a success.
    fn check_head(&self, head: &[u8]) -> Result<(String, Option<usize>), SourceError> {
        let name = || self.name.clone();
        let mut headers = [httparse::EMPTY_HEADER; 64];
        let mut response = httparse::Response::new(&mut headers);
        response
            .parse(head)
            .map_err(|error| SourceError::Malformed { name: name(), what: error.to_string() })?;
        if response.code != Some(200) {
            let code = response.code.unwrap_or_default();
            let status = format!("{code} {}", response.reason.unwrap_or_default());
            return Err(SourceError::Status { name: name(), status });
        }
        let text = |wanted| header(response.headers, wanted);
        let length = text("Content-Length").and_then(|length| length.trim().parse().ok());
        Ok((text("Content-Type").unwrap_or_default(), length))
    }
}

impl Stream {
    /// The next part.
    fn next(&mut self) -> io::Result<RawFrame> {
        let head = self.bytes.next_part(&self.boundary)?;
        let arrived = Instant::now();
        let bytes = self.bytes.picture(&head, &self.boundary)?;
        self.heard = Instant::now();
        let exposed = stamped(&head, arrived).unwrap_or(arrived);
        Ok(RawFrame { exposed, delivered: self.heard, bytes })
    }
}

fn is_silence(error: &io::Error) -> bool {
    matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut)
}

/// When a part says that it was exposed, if that can be.
fn stamped(head: &PartHead, arrived: Instant) -> Option<Instant> {
    let seconds: f64 = head.timestamp.as_ref()?.trim().parse().ok()?;
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).ok()?.as_secs_f64();
    let age = now - seconds;
    let is_believed = (0.0..OLDEST_STAMP).contains(&age);
    is_believed.then(|| arrived.checked_sub(Duration::from_secs_f64(age)))?
}

impl FrameSource for HttpSource {
    fn next(&mut self) -> Result<Option<RawFrame>, SourceError> {
        if let Some(mut stream) = self.stream.take() {
            return match stream.next() {
                Ok(frame) => {
                    self.stream = Some(stream);
                    Ok(Some(frame))
                }
                // A part that was cut short by the wait is lost; the next begins at its boundary.
                Err(error) if is_silence(&error) && stream.heard.elapsed() < PATIENCE => {
                    self.stream = Some(stream);
                    Ok(None)
                }
                Err(error) => Err(self.failed(error)),
            };
        }
        if let Some(asked) = self.asked {
            std::thread::sleep(INTERVAL.saturating_sub(asked.elapsed()));
        }
        self.asked = Some(Instant::now());
        match self.ask()? {
            Answer::Picture(frame) => Ok(Some(frame)),
            Answer::Stream(stream) => {
                self.stream = Some(stream);
                Ok(None)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Read;
    use std::net::TcpListener;
    use std::thread;

    /// A server that answers each connection with the next of `answers`; its URL.
    fn serve(answers: Vec<Vec<u8>>) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let url = format!("http://{}/cam?x=1", listener.local_addr().unwrap());
        thread::spawn(move || {
            for answer in answers {
                let (mut stream, _) = listener.accept().unwrap();
                let mut request = [0; 1024];
                let length = stream.read(&mut request).unwrap();
                assert!(request[..length].starts_with(b"GET /cam?x=1 HTTP/1.0\r\n"));
                stream.write_all(&answer).unwrap();
            }
        });
        url
    }

    fn frames(url: &str, count: usize) -> Vec<Vec<u8>> {
        let mut source = HttpSource::new(url).unwrap();
        let mut frames = Vec::new();
        while frames.len() < count {
            frames.extend(source.next().unwrap().map(|frame| frame.bytes));
        }
        frames
    }

    #[test]
    fn a_stream_and_single_pictures_are_read() {
        let head =
            b"HTTP/1.1 200 OK\r\nContent-Type: multipart/x-mixed-replace; boundary=cut\r\n\r\n";
        let parts = b"--cut\r\nContent-Length: 3\r\n\r\none\r\n--cut\r\n\r\nother\r\n--cut\r\n";
        let url = serve(vec![[head.as_slice(), parts].concat()]);
        assert_eq!(frames(&url, 2), [b"one".to_vec(), b"other".to_vec()]);
        let measured =
            b"HTTP/1.0 200 OK\r\ncontent-type: image/png\r\ncontent-length: 3\r\n\r\none...";
        let closed = b"HTTP/1.0 200 OK\r\nContent-Type: image/jpeg\r\n\r\nother";
        let url = serve(vec![measured.to_vec(), closed.to_vec()]);
        assert_eq!(frames(&url, 2), [b"one".to_vec(), b"other".to_vec()]);
    }

    #[test]
    fn what_is_no_camera_is_named() {
        let error = |answer: &[u8]| {
            HttpSource::new(&serve(vec![answer.to_vec()])).unwrap().next().unwrap_err()
        };
        let text = error(b"HTTP/1.1 404 Not Found\r\n\r\n").to_string();
        assert!(text.contains("answers 404 Not Found"), "{text}");
        let page = error(b"HTTP/1.1 200 OK\r\nContent-Type: text/html\r\n\r\n<html>");
        assert!(matches!(page, SourceError::Content { .. }) && page.is_lasting());
        let other = error(b"SSH-2.0-OpenSSH_9.6\r\n\r\n");
        assert!(matches!(other, SourceError::Malformed { .. }), "{other}");
        let huge = error(
            b"HTTP/1.1 200 OK\r\nContent-Type: image/png\r\nContent-Length: 99999999999\r\n\r\n",
        );
        assert!(matches!(huge, SourceError::TooLarge { .. }), "{huge}");
        let closed = error(b"");
        assert!(!closed.is_lasting(), "{closed}");
    }

    #[test]
    fn addresses_are_checked() {
        for wrong in ["http://", "http:///a", "http://me:secret@camera/", "http://a b/", "ftp://a"]
        {
            assert!(matches!(HttpSource::new(wrong), Err(SourceError::Address(_))), "{wrong}");
        }
        let source = HttpSource::new("http://camera").unwrap();
        assert_eq!((source.address.as_str(), source.path.as_str()), ("camera:80", "/"));
    }

    /// A stamp of now minus 0.1 s is believed; one of another clock is not.
    #[test]
    fn stamps_are_believed_if_they_can_be() {
        let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_secs_f64();
        let stamp = |seconds: f64| {
            let head = PartHead { length: None, timestamp: Some(seconds.to_string()) };
            let arrived = Instant::now();
            stamped(&head, arrived).map(|exposed| (arrived - exposed).as_secs_f64())
        };
        assert!(stamp(now - 0.1).is_some_and(|age| (0.09..0.5).contains(&age)));
        assert_eq!((stamp(now - 60.0), stamp(now + 60.0)), (None, None));
    }
}
