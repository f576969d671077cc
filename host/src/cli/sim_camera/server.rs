//! Frames for browsers and programs: an MJPEG stream as cameras in networks offer it, and single pictures.
//!
//! Each part, and each single picture, says when it was exposed: `X-Timestamp`, seconds since 1970 by this
//! computer's clock as mjpg-streamer has it, and `X-Simulated-Time`, seconds of the simulation. A client that
//! reads slowly gets fewer frames, never old ones.

use crate::cli::error::{CliError, Exit};
use crate::cli::output::Output;
use hil_sim::camera::Frame;
use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, SystemTime};

/// Of 100: what a careful camera uses.
const QUALITY: u8 = 90;
/// So many clients at once; others are told to come later.
const MOST_CLIENTS: usize = 16;
/// A client that takes longer to ask, or to take bytes, is gone.
const PATIENCE: Duration = Duration::from_secs(5);
/// A request's head is shorter than this, bytes.
const LONGEST_HEAD: u64 = 16 << 10;
/// What stands between the frames of a stream.
const BOUNDARY: &str = "frame";
const PAGE: &str =
    "<!doctype html><title>wmr sim</title><img src=\"/stream\" alt=\"the camera's picture\">\n";

/// A server of the newest frame.
#[derive(Debug)]
pub(super) struct Server {
    shared: Arc<Shared>,
    /// The last frame's exposure since 1970.
    last: Duration,
}

#[derive(Debug, Default)]
struct Shared {
    newest: Mutex<Option<Arc<Shot>>>,
    came: Condvar,
    clients: AtomicUsize,
}

/// A frame as it is sent.
#[derive(Debug)]
struct Shot {
    number: u64,
    /// Its headers, with their empty line.
    head: String,
    jpeg: Vec<u8>,
}

impl Server {
    /// Serves at `name`, an address or a port of this computer, and says where.
    pub(super) fn open(name: &str, output: Output) -> Result<Self, CliError> {
        let failed = |error: io::Error| {
            let message = format!("the camera cannot be offered at {name}: {error}");
            CliError::new(Exit::Port, "port.offer", message, "write it as 127.0.0.1:8080 or 8080")
        };
        let listener = match name.trim_start_matches(':').parse::<u16>() {
            Ok(port) => TcpListener::bind(("127.0.0.1", port)),
            Err(_) => TcpListener::bind(name),
        }
        .map_err(failed)?;
        let address = listener.local_addr().map_err(failed)?;
        output
            .say(&format!("camera at http://{address}/stream and /snapshot.jpg{}", warn(address)));
        let shared = Arc::new(Shared::default());
        let served = Arc::clone(&shared);
        thread::Builder::new()
            .name("camera".into())
            .spawn(move || accept(&listener, &served))
            .map_err(failed)?;
        Ok(Self { shared, last: Duration::ZERO })
    }

    /// Shows a frame from now on; `now` is the simulation's time.
    pub(super) fn show(&mut self, frame: &Frame, now: Duration) -> Result<(), CliError> {
        let mut jpeg = Vec::new();
        JpegEncoder::new_with_quality(&mut jpeg, QUALITY)
            .encode(&frame.rgb, frame.width as u32, frame.height as u32, ExtendedColorType::Rgb8)
            .map_err(|error| super::not_encoded(&error))?;
        let age = now.saturating_sub(frame.exposed);
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        // A simulation that catches up with the clock shows frames closer to each other than it exposed them.
        self.last = since_1970.unwrap_or_default().saturating_sub(age).max(self.last);
        let head = format!(
            "Content-Type: image/jpeg\r\nContent-Length: {}\r\nX-Timestamp: {:.6}\r\n\
             X-Simulated-Time: {:.6}\r\n\r\n",
            jpeg.len(),
            self.last.as_secs_f64(),
            frame.exposed.as_secs_f64(),
        );
        let mut newest = self.shared.newest();
        let number = newest.as_ref().map_or(1, |shot| shot.number + 1);
        *newest = Some(Arc::new(Shot { number, head, jpeg }));
        self.shared.came.notify_all();
        Ok(())
    }
}

fn warn(address: SocketAddr) -> &'static str {
    if address.ip().is_loopback() { "" } else { "; everybody in the network can see it" }
}

impl Shared {
    fn newest(&self) -> MutexGuard<'_, Option<Arc<Shot>>> {
        // What is behind the lock is replaced as a whole, so a thread that died left it sound.
        self.newest.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// A frame newer than number `last`, as soon as there is one; `None` if none came for a while.
    fn newer_than(&self, last: u64) -> Option<Arc<Shot>> {
        let is_old =
            |shot: &mut Option<Arc<Shot>>| shot.as_ref().is_none_or(|it| it.number <= last);
        let waited = self.came.wait_timeout_while(self.newest(), PATIENCE, is_old);
        let (shot, timeout) = waited.unwrap_or_else(PoisonError::into_inner);
        if timeout.timed_out() { None } else { shot.clone() }
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for stream in listener.incoming() {
        // A client that is gone before it is served needs nothing.
        let Ok(mut stream) = stream else { continue };
        let shared = Arc::clone(shared);
        if shared.clients.fetch_add(1, Ordering::Relaxed) >= MOST_CLIENTS {
            shared.clients.fetch_sub(1, Ordering::Relaxed);
            let _ = refuse(&mut stream, "503 Service Unavailable");
            continue;
        }
        let served = thread::Builder::new().name("camera client".into()).spawn({
            let shared = Arc::clone(&shared);
            move || {
                // An error is the client's going away.
                let _ = answer(&mut stream, &shared);
                shared.clients.fetch_sub(1, Ordering::Relaxed);
            }
        });
        if served.is_err() {
            shared.clients.fetch_sub(1, Ordering::Relaxed);
        }
    }
}

fn answer(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let request = read_request(stream)?;
    let mut words = request.split_ascii_whitespace();
    let (method, target) = (words.next(), words.next().unwrap_or_default());
    if method != Some("GET") {
        return refuse(stream, "405 Method Not Allowed");
    }
    match target.split('?').next().unwrap_or_default() {
        "/" => {
            let length = PAGE.len();
            let head = format!("Content-Type: text/html\r\nContent-Length: {length}\r\n\r\n");
            write_head(stream, &head)?;
            stream.write_all(PAGE.as_bytes())
        }
        "/stream" => write_stream(stream, shared),
        "/snapshot.jpg" => match shared.newer_than(0) {
            Some(shot) => {
                write_head(stream, &shot.head)?;
                stream.write_all(&shot.jpeg)
            }
            None => refuse(stream, "503 Service Unavailable"),
        },
        _ => refuse(stream, "404 Not Found"),
    }
}

/// The first line of a request; the rest of its head is read and says nothing of interest.
fn read_request(stream: &TcpStream) -> io::Result<String> {
    let mut lines = BufReader::new(stream.take(LONGEST_HEAD));
    let mut first = String::new();
    lines.read_line(&mut first)?;
    let mut line = String::new();
    while lines.read_line(&mut line)? > 2 {
        line.clear();
    }
    Ok(first)
}

fn write_head(stream: &mut TcpStream, headers: &str) -> io::Result<()> {
    // Version 1.0: the answer ends with the connection.
    let common = "HTTP/1.0 200 OK\r\nCache-Control: no-store\r\nConnection: close\r\n";
    stream.write_all(format!("{common}{headers}").as_bytes())
}

fn refuse(stream: &mut TcpStream, status: &str) -> io::Result<()> {
    write!(stream, "HTTP/1.0 {status}\r\nContent-Length: 0\r\nConnection: close\r\n\r\n")
}

fn write_stream(stream: &mut TcpStream, shared: &Shared) -> io::Result<()> {
    stream.set_nodelay(true)?;
    let kind = format!("Content-Type: multipart/x-mixed-replace; boundary={BOUNDARY}\r\n\r\n");
    write_head(stream, &kind)?;
    let mut last = 0;
    loop {
        // A camera may be silent for long; the client decides when that is too long.
        let Some(shot) = shared.newer_than(last) else { continue };
        last = shot.number;
        stream.write_all(format!("--{BOUNDARY}\r\n{}", shot.head).as_bytes())?;
        stream.write_all(&shot.jpeg)?;
        stream.write_all(b"\r\n")?;
    }
}
