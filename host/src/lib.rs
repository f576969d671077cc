//! From an overhead photo to a driven robot.
//!
//! ```text
//! photo ─► vision ─► scene ─► grid ─► plan ─► legs ─► link ═serial═ robot
//!          metres    boxes    areas   points  poses   frames
//! ```
//! Every stage is a module, usable alone, that names only what stands to its left;
//! [`picture`] draws what each stage saw; [`uf2`] packs the robot's firmware for flashing.
//!
//! # From a photo to a driven robot
//!
//! The robot is simulated here; a real one is behind [`link::reopening::Reopening`].
//!
#![cfg_attr(feature = "simulation", doc = "```")]
#![cfg_attr(not(feature = "simulation"), doc = "```ignore")]
//! use wmr::geometry::{Arena, Point, Pose};
//! use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs, to_wire};
//! use wmr::link::{LinkClient, drive::drive, mission::Mission};
//! use wmr::plan::{PlanOptions, plan};
//! use wmr::vision::{DetectOptions, decode, detect};
//! use wmr::{protocol::motion::Timing, scene::Scene, simulated};
//!
//! let photo = decode(include_bytes!("../assets/demo.png"))?;
//! let arena = Arena { width: 1.3, height: 1.55 };
//! let seen = detect(&photo, arena, &DetectOptions::default())?;
//! let (scene, start) = (Scene::from_detection(&seen, arena, 0.075), seen.robot.unwrap());
//!
//! let goal = Point::new(0.996, 0.229);
//! let options = PlanOptions { margin: 0.01, ..PlanOptions::default() };
//! let path = plan(&scene, start.position, goal, &options)?;
//! let options = LegOptions { timing: Timing::Limits, reverse: true };
//! let legs = to_legs(&path.waypoints, start.heading, None, &options, &DEFAULT_LIMITS);
//!
//! let mut client = LinkClient::new(simulated::robot_in(&scene, start, 1), 1);
//! let mut mission = Mission::new(legs, to_wire(start));
//! drive(&mut client, &mut mission, || false, |_, _| ())?;
//! let truth = client.port_mut().truth();
//! assert!(Pose::from(truth.pose).position.distance(goal) < 0.005);
//! assert_eq!(truth.collision_log.unwrap().collisions, 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # I/O
//!
//! [`link::port`] opens serial ports and TCP connections, [`link::reopening`] opens them again, and the
//! list of ports reads what Linux says of USB under `/sys`. [`watch::source`] reads frames on threads of its own, and
//! [`watch::LiveWatcher`] looks at them on another. Everything else is pure: bytes, values and
//! the caller's time in, values out. Nothing here prints, reads a clock on its own account or exits.
//!
//! # Errors
//!
//! An error's text says what is wrong and why, with the values; what to do about it is its help, which
//! [`Diagnostic`] gives:
//!
//! ```
//! use wmr::{Diagnostic, vision::decode};
//! let error = decode(b"ftyp").unwrap_err();
//! assert!(error.help().unwrap().to_string().contains("give a complete PNG or JPEG file"));
//! ```
//!
//! # Where is what
//!
//! | question | answer |
//! |---|---|
//! | Where is the floor's border chosen? | `vision/border` |
//! | Where are shadows modelled? | `vision/appearance` (`floor`, `shadow`); those that boxes cast in `vision/boxes` (`light`) |
//! | Where does a turned box or a disc get its shape? | `vision/outline`, where `vision/boxes` (`shaped`) finds that boxes explain it badly |
//! | Where are shapes of any form planned around? | `plan/disc` for the exact planner; `grid` (`enlarge`) covers them with rectangles for the paper's |
//! | Where is a way found whose edges are unsure? | `plan/fuzzy`: membership of areas, fast marching, and a taut way on the true shapes |
//! | Where is the camera's pose joined with odometry, where do obstacles get a velocity? | `track`: `pose`, an extended Kalman filter of pose and wheels; `obstacles` |
//! | Where is a way found among things that move? | `dynamic`: predicted sets over time, a search in places and time, and what becomes of legs that are driven; `watch/drive` (`moving`) asks it after each frame |
//! | Where does a box get its margin? | `vision/boxes` (`refine`, and `uncovered` for what no box explains); [`plan::with_margin_fallback`] chooses the margin for driving |
//! | Where is a leg's time made? | [`protocol::motion`], shared by host and robot; [`legs`] asks it |
//! | Where does a lost frame come back? | [`protocol::session`], at both ends; [`link::LinkClient`] is the host's |
//!
//! # Frames and units
//!
//! The arena frame has its origin at the floor's lower-left corner as the picture
//! shows it, x to the right, y up, headings counter-clockwise from +x in (-π, π]; lengths in metres.

pub mod calibration;
pub mod document;
pub mod dynamic;
pub mod geometry;
pub mod grid;
pub mod legs;
pub mod link;
pub mod map;
pub mod picture;
pub mod plan;
pub mod plan_file;
pub mod run_log;
pub mod scene;
pub mod shape;
#[cfg(feature = "simulation")]
pub mod simulated;
pub mod track;
pub mod uf2;
pub mod vision;
pub mod watch;
pub mod wiring_check;

/// What an error's help is asked by.
pub use miette::Diagnostic;
/// The wire format, whose motion types appear in this crate's signatures.
pub use protocol;
