//! How much faster than the clock missions run, without a camera: the robot's logic in this process, and the
//! flashed ELF if one is named.
//!
//! ```text
//! cargo run --release -p wmr-tests --example speed [ELF]
//! ```

use hil_sim::base::{BaseParameters, TruePose, WheeledBase};
use hil_sim::emulator::EmulatedPico;
use hil_sim::in_process::InProcess;
use hil_sim::simulation::{Firmware, Simulation};
use protocol::motion::{Pose, Timing};
use std::error::Error;
use std::path::Path;
use std::time::{Duration, Instant};
use wmr::geometry::{Point, Rect};
use wmr::legs::{DEFAULT_LIMITS, LegOptions, to_legs};
use wmr::link::LinkClient;
use wmr::link::drive::drive;
use wmr::link::mission::Mission;
use wmr::scene::Scene;

/// Missions are driven again and again for so long.
const MEASURED: Duration = Duration::from_secs(5);
const WAY: [[f64; 2]; 4] = [[0.3, 0.3], [1.2, 0.4], [1.6, 1.1], [0.4, 1.2]];

fn main() -> Result<(), Box<dyn Error>> {
    let share = speed(|| Ok(InProcess::default()))?;
    println!("in process: {share:.0} × real time (promised: 2000)");
    if let Some(elf) = std::env::args().nth(1) {
        let share = speed(|| Ok(EmulatedPico::spawn(Path::new(&elf))?))?;
        println!("ELF: {share:.1} × real time (promised: 3)");
    }
    Ok(())
}

/// Simulated time over time on the wall, the start of the firmware left out.
fn speed<B: Firmware>(
    firmware: impl Fn() -> Result<B, Box<dyn Error>>,
) -> Result<f64, Box<dyn Error>> {
    let (mut simulated, mut spent) = (Duration::ZERO, Duration::ZERO);
    while spent < MEASURED {
        let firmware = firmware()?;
        let began = Instant::now();
        simulated += mission(firmware)?;
        spent += began.elapsed();
    }
    Ok(simulated.as_secs_f64() / spent.as_secs_f64())
}

/// Drives past six boxes; how long that takes the robot.
fn mission<B: Firmware>(firmware: B) -> Result<Duration, Box<dyn Error>> {
    let mut scene = Scene::new(2.0, 1.5);
    for (x, y) in [(0.5, 0.6), (0.8, 0.7), (1.1, 0.7), (1.8, 0.2), (1.85, 0.6), (0.1, 0.8)] {
        scene.obstacles.push(Rect::new(x, y, x + 0.1, y + 0.1).into());
    }
    let way = WAY.map(|[x, y]| Point::new(x, y));
    let start = Pose::new(0.3, 0.3, 0.0);
    let base = WheeledBase::new(
        BaseParameters::seeded(1),
        TruePose { x: way[0].x, y: way[0].y, heading: 0.0 },
    );
    let options = LegOptions { timing: Timing::Limits, reverse: false };
    let legs = to_legs(&way, 0.0, None, &options, &DEFAULT_LIMITS);
    let simulation = Simulation::new(firmware, base, Some((&scene).into()));
    let mut client = LinkClient::new(simulation, 1);
    drive(&mut client, &mut Mission::new(legs, start), || false, |_, _| ())?;
    Ok(client.port_mut().now())
}
