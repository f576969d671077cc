//! A real `wmr serve` for tests, and requests to it over real sockets.
#![allow(dead_code, reason = "each test file uses a part")]
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]

use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A server of its own for each test.
pub(crate) struct Server {
    pub(crate) process: Child,
    pub(crate) host: String,
    pub(crate) token: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}

/// How long something may take on a busy computer before a test gives it up.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

pub(crate) fn program(arguments: &[&str]) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_wmr"));
    // A browser is not to be opened on the computer of whoever runs the tests.
    command.env_remove("DISPLAY").env_remove("WAYLAND_DISPLAY").env_remove("WMR_PORT");
    // What is driven is kept in the current folder.
    command.current_dir(env!("CARGO_TARGET_TMPDIR"));
    command.args(arguments).stderr(Stdio::piped()).stdout(Stdio::piped()).spawn().unwrap()
}

/// What a program says first.
pub(crate) fn first_line(process: &mut Child) -> String {
    let mut line = String::new();
    BufReader::new(process.stderr.take().unwrap()).read_line(&mut line).unwrap();
    line
}

impl Server {
    pub(crate) fn start() -> Self {
        Self::start_at("20")
    }

    /// The same with a robot `speed` times as fast as the clock.
    pub(crate) fn start_at(speed: &str) -> Self {
        Self::start_with(&["serve", "--addr", "127.0.0.1:0", "--no-open", "--sim-speed", speed])
    }

    pub(crate) fn start_with(arguments: &[&str]) -> Self {
        let mut process = program(arguments);
        let line = first_line(&mut process);
        let (_, rest) = line.split_once("http://").unwrap();
        let (host, rest) = rest.split_once("/?t=").unwrap();
        let token = rest.split_whitespace().next().unwrap();
        Self { host: host.into(), token: token.into(), process }
    }

    pub(crate) fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        stream
    }

    /// Status and body of a request with exactly these heads.
    pub(crate) fn raw(&self, line: &str, heads: &[(&str, &str)], body: &[u8]) -> (u16, Vec<u8>) {
        let mut stream = self.connect();
        let mut head = format!("{line} HTTP/1.1\r\nConnection: close\r\n");
        heads.iter().for_each(|(name, value)| head += &format!("{name}: {value}\r\n"));
        if !body.is_empty() {
            head += &format!("Content-Length: {}\r\n", body.len());
        }
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        // A server that refuses a body need not read it.
        let _ = stream.write_all(body);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        let text = String::from_utf8_lossy(&answer);
        let status = text.split(' ').nth(1).and_then(|code| code.parse().ok()).unwrap_or(0);
        let end = answer.windows(4).position(|four| four == b"\r\n\r\n").map_or(0, |at| at + 4);
        (status, answer.split_off(end))
    }

    pub(crate) fn send(&self, path: &str, kind: &str, body: &[u8]) -> (u16, Value) {
        let bearer = format!("Bearer {}", self.token);
        let heads =
            [("Host", self.host.as_str()), ("Authorization", &bearer), ("Content-Type", kind)];
        let (status, body) = self.raw(&format!("POST {path}"), &heads, body);
        (status, serde_json::from_slice(&body).unwrap_or(Value::Null))
    }

    pub(crate) fn post(&self, what: &str, body: &Value) -> (u16, Value) {
        self.send(&format!("/api/{what}"), "application/json", body.to_string().as_bytes())
    }

    /// A request that must succeed.
    pub(crate) fn done(&self, what: &str, body: &Value) -> Value {
        let (status, document) = self.post(what, body);
        assert_eq!(status, 200, "{what}: {document}");
        document
    }

    pub(crate) fn state(&self) -> Value {
        let (status, body) = self.raw("GET /api/state", &[("Host", &self.host)], b"");
        assert_eq!(status, 200);
        serde_json::from_slice(&body).unwrap()
    }

    /// The state as soon as it is as wanted.
    pub(crate) fn when(&self, what: &str, wanted: impl Fn(&Value) -> bool) -> Value {
        let began = Instant::now();
        loop {
            let state = self.state();
            if wanted(&state) {
                return state;
            }
            assert!(began.elapsed() < PATIENCE, "never {what}: {}", state["drive"]);
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Lays the sample on the desk and plans to the demo's goal.
    pub(crate) fn plan_sample(&self) -> Value {
        self.done("photo", &json!({"sample": "demo"}));
        self.done("detect", &json!({}));
        self.done("plan", &json!({"goal": [0.996, 0.229]}))
    }

    /// Opens a web socket; the status of the answer and the stream behind it.
    pub(crate) fn open_socket(&self, token: &str, heads: &[(&str, &str)]) -> (u16, TcpStream) {
        let mut stream = self.connect();
        let mut head = format!(
            "GET /ws?t={token} HTTP/1.1\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n"
        );
        heads.iter().for_each(|(name, value)| head += &format!("{name}: {value}\r\n"));
        stream.write_all(format!("{head}\r\n").as_bytes()).unwrap();
        let mut answer = Vec::new();
        while !answer.ends_with(b"\r\n\r\n") {
            let mut byte = [0];
            stream.read_exact(&mut byte).unwrap();
            answer.push(byte[0]);
        }
        let text = String::from_utf8(answer).unwrap();
        (text.split(' ').nth(1).unwrap().parse().unwrap(), stream)
    }
}

/// The next text message of a socket; pings are passed over.
pub(crate) fn next_text(stream: &mut TcpStream) -> Value {
    loop {
        let mut head = [0; 2];
        stream.read_exact(&mut head).unwrap();
        let length = match head[1] & 0x7f {
            126 => {
                let mut long = [0; 2];
                stream.read_exact(&mut long).unwrap();
                usize::from(u16::from_be_bytes(long))
            }
            short => usize::from(short),
        };
        let mut body = vec![0; length];
        stream.read_exact(&mut body).unwrap();
        if head[0] & 0x0f == 1 {
            return serde_json::from_slice(&body).unwrap();
        }
    }
}

pub(crate) fn is_at_rest(state: &Value) -> bool {
    state["drive"]["active"] == false
}
