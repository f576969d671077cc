//! A cable that is pulled and plugged in again, often, on a pseudo-terminal in real time.

use crate::link::ORIGIN;
use crate::simulated_robot;
use hil_sim::pty::Pty;
use hil_sim::realtime;
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::{Duration, Instant};
use wmr::link::LinkClient;
use wmr::link::reopening::Reopening;

/// Nobody waits longer than this for a robot to be back.
const TOO_LONG: Duration = Duration::from_secs(10);

/// Between two looks at a port.
const PAUSE: Duration = Duration::from_millis(1);

/// Pulls the cable of a simulated robot at `link` and plugs it in again, `cycles` times; how long each
/// time it took until it was heard again, in one session, without a restart of either side.
///
/// # Panics
/// If it does not come back.
pub fn replug(link: &Path, cycles: u32) -> Vec<Duration> {
    let (plugged, over, plugs) = (AtomicBool::new(true), AtomicBool::new(false), AtomicU32::new(0));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let mut simulation = simulated_robot(ORIGIN, 1);
            while !over.load(Ordering::SeqCst) {
                if plugged.load(Ordering::SeqCst) {
                    let Ok(mut pty) = Pty::open(Some(link)) else { panic!("no pseudo-terminal") };
                    plugs.fetch_add(1, Ordering::SeqCst);
                    let end = realtime::run(&mut simulation, &mut pty, |_| {
                        plugged.load(Ordering::SeqCst) && !over.load(Ordering::SeqCst)
                    });
                    assert!(end.is_ok(), "{end:?}");
                    drop(pty);
                    plugs.fetch_add(1, Ordering::SeqCst);
                } else {
                    std::thread::sleep(PAUSE);
                }
            }
        });
        wait_for(&plugs, 1);
        let times = pull_and_plug(link, cycles, &plugged, &plugs);
        over.store(true, Ordering::SeqCst);
        times
    })
}

fn pull_and_plug(
    link: &Path,
    cycles: u32,
    plugged: &AtomicBool,
    plugs: &AtomicU32,
) -> Vec<Duration> {
    let port = Reopening::open(&link.display().to_string());
    let Ok(port) = port else { panic!("{port:?}") };
    let mut client = LinkClient::new(port, 1).with_patience(TOO_LONG);
    let start = Instant::now();
    let mut hear = || {
        let asked = Instant::now();
        let before = client.telemetry().map(|telemetry| telemetry.ticks);
        while client.telemetry().map(|telemetry| telemetry.ticks) == before {
            let reports = client.poll(start.elapsed());
            assert!(reports.is_ok(), "{reports:?}");
            std::thread::sleep(PAUSE);
        }
        asked.elapsed()
    };
    hear();
    (0..cycles)
        .map(|cycle| {
            plugged.store(false, Ordering::SeqCst);
            wait_for(plugs, 2 * cycle + 2);
            plugged.store(true, Ordering::SeqCst);
            wait_for(plugs, 2 * cycle + 3);
            // The first word may have been on its way before; the second cannot.
            hear() + hear()
        })
        .collect()
}

fn wait_for(plugs: &AtomicU32, number: u32) {
    let start = Instant::now();
    while plugs.load(Ordering::SeqCst) < number {
        assert!(start.elapsed() < TOO_LONG, "the robot's side does not go on");
        std::thread::sleep(PAUSE);
    }
}
