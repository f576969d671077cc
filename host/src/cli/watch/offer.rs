//! What the camera has taught of the robot's wheels, offered at the end of a drive.

use crate::cli::endpoint::Endpoint;
use crate::cli::output::Output;
use crate::cli::params;
use wmr::calibration::BaseLengths;
use wmr::link::LinkClient;
use wmr::track::pose::{Calibration, Measured};

/// A factor known worse than this is no news.
const SURE: f64 = 0.004;
/// Nor is one that differs from 1 by less than so many standard deviations.
const NEWS: f64 = 3.0;

/// Offers better numbers, if the drive has told some.
pub(super) fn calibration(
    client: &mut LinkClient<Box<dyn Endpoint>>,
    learnt: Option<Calibration>,
    port: &str,
    output: Output,
) {
    let Some(learnt) = learnt else { return };
    if ![learnt.scale, learnt.ratio, learnt.track].into_iter().any(is_news) {
        return;
    }
    // A robot that does not answer any more has arrived all the same.
    let Ok(parameters) = params::read(client) else { return };
    output.say(&offer(learnt, BaseLengths::of(&parameters), port));
}

fn is_news(factor: Measured) -> bool {
    factor.sigma < SURE && (factor.value - 1.0).abs() > NEWS * factor.sigma
}

/// The factors that are news, and the command that keeps them.
fn offer(learnt: Calibration, used: BaseLengths, port: &str) -> String {
    let lengths = [
        ("wheel radius", "wheel-radius", used.wheel_radius, learnt.scale),
        ("wheel ratio", "wheel-ratio", used.wheel_ratio, learnt.ratio),
        ("track", "track", used.track, learnt.track),
    ];
    let news: Vec<_> = lengths.into_iter().filter(|(.., factor)| is_news(*factor)).collect();
    let factors: Vec<_> = news
        .iter()
        .map(|(name, _, _, factor)| {
            format!("{name} \u{d7} {:.4} \u{b1} {:.4}", factor.value, factor.sigma)
        })
        .collect();
    let changes: Vec<_> = news
        .iter()
        .map(|(_, name, used, factor)| format!("{name}={:.5}", used * factor.value))
        .collect();
    format!(
        "the camera says: {}; keep it? wmr params {} --port {port}",
        factors.join(", "),
        changes.join(" ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_news_is_offered() {
        let measured = |value, sigma| Measured { value, sigma };
        let learnt = Calibration {
            scale: measured(1.001, 0.0005),
            ratio: measured(1.0043, 0.0004),
            track: measured(1.02, 0.01),
        };
        let used = BaseLengths { wheel_radius: 0.035, wheel_ratio: 1.0, track: 0.12 };
        assert_eq!(
            offer(learnt, used, "auto"),
            "the camera says: wheel ratio × 1.0043 ± 0.0004; keep it? wmr params wheel-ratio=1.00430 --port auto"
        );
    }
}
