//! `wmr serve`: the page on which a person sees what was recognised, corrects it, drives and stops.
//!
//! ```text
//! page ═HTTP, web socket═ router ─► desk (photo, scene, plan)
//!                            │  └──► jobs (one heavy one at a time)
//!                            ├─ controls ─► robot thread ═link═ robot
//!                            └─ camera ─► frames to pages, what is seen to the robot thread
//! ```
//! The documents are those of the command line with `--json`; the interface is described in
//! `openapi.json`, which a test holds against the router. The robot has a thread of its own, which takes
//! no lock that is held for longer than a copy and waits for no request: whatever a page sends, it
//! drives, pauses and stops. SI units and radians; pixels only for corners and photos.

mod archive;
mod base;
mod calibrating;
mod camera;
mod corrections;
mod desk;
mod driving;
mod error;
mod faults;
mod files;
mod frames;
mod handlers;
mod jobs;
mod live;
mod lookout;
mod paced;
mod planned;
mod reading;
mod reference;
mod requests;
mod robot;
mod router;
mod security;
mod service;
mod socket;
mod status;
mod steps;
mod watched;

use crate::cli::error::{CliError, Exit};
use crate::cli::mission::{catch_interrupts, interrupted};
use crate::cli::output::Output;
use crate::cli::stop_desk;
use archive::Archive;
use camera::Lookout;
use desk::Desk;
use faults::FaultWish;
use frames::FrameLog;
use jobs::Jobs;
use live::{Controls, Live};
use lookout::GivenCamera;
use robot::{Order, RobotSettings};
use security::{Guard, Token};
use serde_json::json;
use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;
use tokio::net::TcpListener;
use tokio::sync::watch;

/// What `wmr serve` is asked for.
#[derive(Clone, Debug)]
pub(crate) struct Settings {
    /// Where the page is.
    pub(crate) address: String,
    /// The robot's port.
    pub(crate) port: String,
    /// Simulated seconds that pass in a second.
    pub(crate) speed: f64,
    /// Which of many slightly different robots is simulated.
    pub(crate) seed: u64,
    /// A camera that is on from the beginning, and how much older its pictures are than it says.
    pub(crate) watch: Option<String>,
    pub(crate) watch_delay: Duration,
    /// Where drives are kept.
    pub(crate) log: PathBuf,
    /// Whether to show the page in the browser.
    pub(crate) open: bool,
    /// Whether the mission of `wmr demo` lies on the desk already.
    pub(crate) demo: bool,
}

/// What all requests share.
#[derive(Clone)]
struct Dashboard {
    desk: Arc<Mutex<Desk>>,
    live: Arc<Mutex<Live>>,
    controls: Arc<Controls>,
    jobs: Jobs,
    orders: SyncSender<Order>,
    /// The port that the program was started with.
    first_port: Arc<str>,
    faults: FaultWish,
    camera: Lookout,
    /// The camera that the program was started with.
    given_camera: Arc<GivenCamera>,
    frames: FrameLog,
    archive: Archive,
    guard: Arc<Guard>,
    /// The state as the sockets get it, made once for all of them.
    status: watch::Sender<axum::extract::ws::Utf8Bytes>,
}

/// A lock that goes on after a panic of another holder: every value behind one is whole at any time.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// After Ctrl-C, how often it is looked for.
const INTERRUPT_INTERVAL: Duration = Duration::from_millis(50);

/// Serves the page until Ctrl-C; a robot that drives has then stopped.
pub(crate) fn serve(settings: &Settings, output: Output) -> Result<(), CliError> {
    catch_interrupts();
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .map_err(|error| cannot_serve(&settings.address, &error))?;
    let listener = runtime
        .block_on(TcpListener::bind(&settings.address))
        .map_err(|error| cannot_serve(&settings.address, &error))?;
    let address = listener.local_addr().map_err(|error| cannot_serve(&settings.address, &error))?;
    let (dashboard, robot) = start(settings, address);
    if let Some(source) = &settings.watch {
        begin_watching(&dashboard, source)?;
    }
    if settings.demo {
        planned::lay_demo(&mut lock(&dashboard.desk)).map_err(|failure| failure.error)?;
    }
    announce(settings, &dashboard.guard, output)?;
    runtime.block_on(async {
        tokio::spawn(status::keep(dashboard.clone()));
        let server = axum::serve(listener, router::router(dashboard.clone()));
        tokio::select! {
            result = server => result.map_err(|error| cannot_serve(&settings.address, &error)),
            () = interrupt(&dashboard) => Ok(()),
        }
    })?;
    dashboard.controls.end();
    // A thread that panicked has nothing more to say; its robot stops by itself.
    let _ = robot.join();
    let help = "wmr serve opens it again";
    let error = CliError::new(Exit::Interrupted, "interrupted", "the page is closed", help);
    // What programs need was said when the page was opened.
    Err(CliError { after_result: true, ..error })
}

/// All that requests share, and the thread that has the robot.
fn start(settings: &Settings, address: SocketAddr) -> (Dashboard, std::thread::JoinHandle<()>) {
    let live = Arc::new(Mutex::new(Live::new(&settings.port)));
    let controls = Arc::new(Controls::default());
    let (faults, frames) = (FaultWish::default(), FrameLog::default());
    let camera = Lookout::default();
    let given = GivenCamera { source: settings.watch.clone(), delay: settings.watch_delay };
    let archive = Archive::new(&settings.log);
    let robot_settings = RobotSettings {
        port: settings.port.clone(),
        speed: settings.speed,
        seed: settings.seed,
        faults: faults.clone(),
        camera: camera.clone(),
        frames: frames.clone(),
        archive: archive.clone(),
    };
    let (orders, thread) = robot::spawn(robot_settings, live.clone(), controls.clone());
    let dashboard = Dashboard {
        desk: Arc::default(),
        live,
        controls,
        jobs: Jobs::default(),
        orders,
        first_port: settings.port.as_str().into(),
        faults,
        camera,
        given_camera: Arc::new(given),
        frames,
        archive,
        guard: Arc::new(Guard { address, token: Token::random() }),
        status: watch::Sender::default(),
    };
    (dashboard, thread)
}

/// Switches on the camera that the program was started with.
fn begin_watching(dashboard: &Dashboard, source: &str) -> Result<(), CliError> {
    if source == camera::SIMULATED && !lock(&dashboard.live).is_simulated() {
        return Err(CliError::usage(
            "a simulated camera sees a simulated robot alone",
            "say --port sim, or give the --watch of your camera",
        ));
    }
    dashboard.switch_on(source)
}

fn cannot_serve(address: &str, error: &std::io::Error) -> CliError {
    let message = format!("the page cannot be served at {address}: {error}");
    CliError::new(Exit::Port, "serve", message, "choose another with --addr, such as 127.0.0.1:0")
}

/// Says where the page is, and opens it if that is wanted.
fn announce(settings: &Settings, guard: &Guard, output: Output) -> Result<(), CliError> {
    let place = guard.page_address();
    output.say(&format!("wmr at {place}  (robot: {}; Ctrl-C ends it)", settings.port));
    if let Some(address) = guard.network_address() {
        output.say(&format!("in this network: {address}  (who has it can drive the robot)"));
        if let Some(code) = qr_code(&address) {
            output.say(&code);
        }
    }
    if settings.open {
        open_in_browser(&place);
    }
    if output.json {
        let document = json!({"address": place, "token": guard.token.text()});
        return output.result(&document, "");
    }
    Ok(())
}

/// The address for a phone's camera, two modules a character: on a dark terminal dark on light, on a light one
/// the other way round, which today's phones read as well.
fn qr_code(address: &str) -> Option<String> {
    use qrcode::render::unicode::Dense1x2;
    let code = qrcode::QrCode::new(address).ok()?;
    let mut drawing = code.render::<Dense1x2>();
    Some(drawing.dark_color(Dense1x2::Light).light_color(Dense1x2::Dark).build())
}

/// Asks the desktop to show the page; where there is none, the address is printed all the same.
fn open_in_browser(address: &str) {
    let (program, arguments): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("cmd", &["/c", "start", ""])
    } else if std::env::var_os("DISPLAY").is_some() || std::env::var_os("WAYLAND_DISPLAY").is_some()
    {
        ("xdg-open", &[])
    } else {
        return;
    };
    use std::process::{Command, Stdio};
    let quiet = Stdio::null;
    let mut command = Command::new(program);
    command.args(arguments).arg(address).stdin(quiet()).stdout(quiet()).stderr(quiet());
    // The person can still open it by hand.
    let _ = command.spawn();
}

/// Until Ctrl-C; meanwhile a stop that another program asks for is passed on, and confirmed at rest.
async fn interrupt(dashboard: &Dashboard) {
    let mut asked = false;
    while !interrupted() {
        let was_asked = asked;
        asked = stop_desk::asked();
        if asked && !was_asked {
            dashboard.controls.stop();
        }
        tokio::time::sleep(INTERRUPT_INTERVAL).await;
        // What the robot said before the stop reached it does not count.
        if was_asked && lock(&dashboard.live).has_stopped() {
            stop_desk::confirm();
        }
    }
}
