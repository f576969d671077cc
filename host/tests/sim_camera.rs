//! `wmr sim` with a camera: frames in a folder and over HTTP, and what `wmr detect` makes of them.
#![allow(clippy::unwrap_used, clippy::panic, reason = "helpers of tests fail as tests do")]
#![cfg(unix)]

mod program;

use program::{assert_refused, assert_valid, number, numbers, succeed, write};
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, ChildStderr, Command, Stdio};

const SCENE: &str = r#"{"format":"wmr-scene/1","arena":{"width":2,"height":1.5},
    "obstacles":[[0.9,0.3,1.15,0.75]],"start":[0.45,0.4,0.7],"goal":[0.8,1.2]}"#;
const SCENARIO: &str = "title = \"seen\"\n[world]\nsize = [2.0, 1.5]\nradius = 0.075\n\
    shapes = [{ rect = [0.9, 0.3, 1.15, 0.75] }]\n\
    movers = [{ circle = [1.5, 1.2, 0.1], velocity = [0.05, -0.1] }]\n\
    [mission]\nstart = [0.45, 0.4, 0.7]\nway = [[0.6, 0.9]]\n\
    [[fault]]\nkind = \"shape\"\ncircle = [1.6, 0.2, 0.1]\n[expect]\ndrive = \"reached\"\n";
/// Less than three pixels of 3.7 mm, m, and what one pixel is at the ends of the robot's mark, rad.
const PLACE: f64 = 0.01;
const HEADING: f64 = 0.045;

/// A simulated robot with a camera, ended with the test.
struct Sim {
    child: Child,
    camera: String,
    _talk: BufReader<ChildStderr>,
}

impl Sim {
    fn start(arguments: &[&str]) -> Self {
        let offer = ["sim", "--tcp", "127.0.0.1:0", "--camera-http", "127.0.0.1:0"];
        let mut child = Command::new(env!("CARGO_BIN_EXE_wmr"))
            .args([&offer, arguments].concat())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut talk = BufReader::new(child.stderr.take().unwrap());
        let mut text = String::new();
        let camera = loop {
            assert!(talk.read_line(&mut text).unwrap() > 0, "{text}");
            if let Some(rest) = text.split("camera at http://").nth(1) {
                break rest.split('/').next().unwrap().to_owned();
            }
        };
        Self { child, camera, _talk: talk }
    }

    fn ask(&self, request: &str) -> BufReader<TcpStream> {
        let mut stream = TcpStream::connect(&self.camera).unwrap();
        write!(stream, "{request} HTTP/1.1\r\nHost: {}\r\n\r\n", self.camera).unwrap();
        BufReader::new(stream)
    }
}

impl Drop for Sim {
    fn drop(&mut self) {
        self.child.kill().unwrap();
        self.child.wait().unwrap();
    }
}

/// The lines of a head, without the empty one.
fn head(reader: &mut impl BufRead) -> Vec<String> {
    let lines = reader.lines().map(Result::unwrap);
    lines.take_while(|line| !line.is_empty()).collect()
}

fn value<'a>(head: &'a [String], name: &str) -> &'a str {
    let found = head.iter().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
    found.unwrap_or_else(|| panic!("{name} is missing: {head:?}"))
}

/// The picture behind a head, its exposure by the clock on the wall and by the simulation.
fn picture(reader: &mut impl Read, head: &[String]) -> (Vec<u8>, [f64; 2]) {
    assert_eq!(value(head, "Content-Type"), "image/jpeg");
    let mut bytes = vec![0; value(head, "Content-Length").parse().unwrap()];
    reader.read_exact(&mut bytes).unwrap();
    let times = ["X-Timestamp", "X-Simulated-Time"].map(|name| value(head, name).parse().unwrap());
    (bytes, times)
}

/// The arena by the picture `path`, whose robot must be at `pose`.
fn check_detected(path: &Path, camera: Option<&Path>, pose: &[f64]) {
    let mut arguments = vec!["detect", path.to_str().unwrap(), "--arena", "2x1.5", "--json"];
    if let Some(camera) = camera {
        arguments.extend(["--camera", camera.to_str().unwrap()]);
    }
    let seen = succeed(&arguments);
    let robot = numbers(&seen["start"]);
    assert!((robot[0] - pose[0]).hypot(robot[1] - pose[1]) < PLACE, "{seen} {pose:?}");
    assert!((robot[2] - pose[2]).sin().abs() < HEADING, "{seen} {pose:?}");
    let is_box = |shape: &Value| {
        let Some(corners) = shape.as_array().filter(|corners| corners.len() == 4) else {
            return false;
        };
        let expected = [0.9, 0.3, 1.15, 0.75];
        corners.iter().map(number).zip(expected).all(|(is, should)| (is - should).abs() < 0.02)
    };
    let obstacles = seen["obstacles"].as_array().unwrap();
    assert!(obstacles.iter().any(is_box), "{seen}");
}

#[test]
fn saved_frames_show_what_their_list_says_and_the_replay_shows_what_moves() {
    let folder = tempfile::tempdir().unwrap();
    let scenario = write(&folder, "seen.toml", SCENARIO);
    let (out, replay) = (folder.path().join("frames"), folder.path().join("replay.svg"));
    let words = [out.to_str().unwrap(), replay.to_str().unwrap()];
    let play = ["sim", "--scenario", &scenario, "--camera-rate", "2", "--json"];
    let end = succeed(&[&play, ["--camera-out", words[0], "-o", words[1]].as_slice()].concat());
    assert_eq!(end["end"], "reached");

    let list = std::fs::read_to_string(out.join("frames.jsonl")).unwrap();
    let frames: Vec<Value> = list.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    assert!(frames.len() >= 4, "{list}");
    frames.iter().for_each(|frame| assert_valid("frame-line", frame));
    for (index, frame) in frames.iter().enumerate() {
        let [exposed, delivered] = ["exposed", "delivered"].map(|name| number(&frame[name]));
        // Twice a second, at the end of the step in which it is time; 80 ms later they are there.
        assert!((exposed - 0.5 * index as f64 - 0.005 * f64::from(index == 0)).abs() < 1e-9);
        assert!((delivered - exposed - 0.08).abs() < 1e-9, "{frame}");
        // The disc's rightmost point: x + radius + velocity × time.
        let disc = numbers(&frame["moving"][0][0]);
        assert!((disc[0] - 1.6 - 0.05 * exposed).abs() < 1e-9, "{frame}");
        assert!((disc[1] - 1.2 + 0.1 * exposed).abs() < 1e-9, "{frame}");
    }
    for index in [0, 3] {
        let frame = &frames[index];
        let path = out.join(frame["file"].as_str().unwrap());
        let pose = numbers(&frame["true_pose"]);
        check_detected(&path, Some(&out.join("camera.json")), &pose);
    }
    let svg = std::fs::read_to_string(&replay).unwrap();
    // The disc that moves, and the one that is put down while it drives.
    assert_eq!(svg.matches("attributeName=\"visibility\"").count(), 2);
    assert!(svg.contains("values=\"hidden;") && svg.contains("values=\"visible;"));
    // A folder that holds frames is no place for others.
    let again = [&play[..5], ["--camera-out", words[0]].as_slice()].concat();
    assert_refused(3, "file.exists", &again);
}

#[test]
fn a_stream_and_single_pictures_are_served_with_the_time_of_their_exposure() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", SCENE);
    let sim = Sim::start(&["--scene", &scene, "--camera-rate", "20"]);
    let mut stream = sim.ask("GET /stream");
    let answer = head(&mut stream);
    assert_eq!(answer[0], "HTTP/1.0 200 OK");
    assert_eq!(value(&answer, "Content-Type"), "multipart/x-mixed-replace; boundary=frame");
    let mut last = [0.0; 2];
    for _ in 0..3 {
        let mut line = String::new();
        stream.read_line(&mut line).unwrap();
        assert_eq!(line, "--frame\r\n");
        let part = head(&mut stream);
        let (jpeg, times) = picture(&mut stream, &part);
        assert!(times[0] >= last[0] && times[1] > last[1], "{times:?} {last:?}");
        // Frames may be left out, never moved in time: all are exposed in steps of 5 ms.
        assert!((times[1] / 0.005 - (times[1] / 0.005).round()).abs() < 1e-6, "{times:?}");
        last = times;
        let frame = image::load_from_memory(&jpeg).unwrap();
        assert_eq!((frame.width(), frame.height()), (640, 480));
        stream.read_line(&mut line).unwrap();
    }
    let mut single = sim.ask("GET /snapshot.jpg?now=1");
    let answer = head(&mut single);
    let (jpeg, times) = picture(&mut single, &answer);
    assert!(times[1] >= last[1]);
    let path = folder.path().join("snapshot.jpg");
    std::fs::write(&path, jpeg).unwrap();
    check_detected(&path, None, &[0.45, 0.4, 0.7]);
    for (request, status) in [("GET /other", "404"), ("POST /stream", "405"), ("GET /", "200")] {
        let answer = head(&mut sim.ask(request));
        assert!(answer[0].starts_with(&format!("HTTP/1.0 {status} ")), "{request}: {answer:?}");
    }
    let taken = ["sim", "--tcp", "127.0.0.1:0", "--scene", &scene, "--camera-http", &sim.camera];
    assert_refused(5, "port.offer", &taken);
}

#[test]
fn a_camera_that_is_dark_sends_dark_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", SCENE);
    let brightness = |arguments: &[&str]| {
        let sim = Sim::start(&[&["--scene", &scene], arguments].concat());
        let mut single = sim.ask("GET /snapshot.jpg");
        let answer = head(&mut single);
        let (jpeg, _) = picture(&mut single, &answer);
        let grey = image::load_from_memory(&jpeg).unwrap().to_luma8();
        grey.pixels().map(|pixel| f64::from(pixel.0[0])).sum::<f64>() / grey.len() as f64
    };
    assert!(brightness(&[]) > 80.0);
    assert!(brightness(&["--fault", "camera-dark"]) < 20.0);
}

#[test]
fn a_camera_that_cannot_be_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let scene = write(&folder, "scene.json", SCENE);
    let out = folder.path().join("frames");
    let sim = ["sim", "--tcp", "127.0.0.1:0"];
    let over = [&sim, ["--scene", &scene].as_slice()].concat();
    let out = ["--camera-out", out.to_str().unwrap()];
    assert_refused(2, "usage", &[&sim, out.as_slice()].concat());
    assert_refused(2, "usage", &[&over, ["--fault", "camera-dark"].as_slice()].concat());
    for wrong in [["--camera-size", "10x10"], ["--camera-rate", "0"], ["--camera-latency", "1h"]] {
        assert_refused(2, "usage", &[&over, out.as_slice(), wrong.as_slice()].concat());
    }
    assert_refused(5, "port.offer", &[&over, ["--camera-http", "nowhere"].as_slice()].concat());
    assert!(!Path::new(out[1]).exists(), "a refused run leaves nothing behind");
}
