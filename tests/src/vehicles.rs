//! The chained form beyond the two-wheeled base: a car (n = 4) and a car with a trailer (n = 5).
//!
//! Both vehicles are brought into the chained form [Alghannam, Eq. 2] in the frame of the arena, with
//! z1 = x of the rearmost axle and each further state the slope of the next. The cosine switch steers
//! z; this module turns z back into the speed and the angle of the front wheels. The vehicles
//! themselves are integrated from their own equations, which know nothing of z.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | x, y | middle of the rearmost axle | m |
//! | θ | heading of the rearmost part, \|θ\| < 90° | rad |
//! | β | heading of the car relative to its trailer | rad |
//! | φ | angle of the front wheels | rad |
//! | l, d | wheel base of the car; from its rear axle to that of the trailer | m |
//! | u | speed of the car's rear axle | m/s |

use firmware::chained_form::ChainedState;
use firmware::cosine_switch::{CosineSwitch, CosineSwitchError};

/// A vehicle in the chained form with `N` states.
pub trait ChainedVehicle<const N: usize> {
    /// The chained state of a configuration.
    fn chained(&self, configuration: &[f64; N]) -> ChainedState<N>;

    /// The configuration of a chained state.
    fn configuration(&self, z: &ChainedState<N>) -> [f64; N];

    /// How fast the configuration changes, but for the steering angle, which is the last and is set
    /// by hand: for v1 = 1, the speed along x of the rearmost axle.
    fn slopes(&self, configuration: &[f64; N]) -> [f64; N];
}

/// A car: (x, y, θ, φ). tan θ = dy/dx, and its slope is tan φ / (l cos³θ).
#[derive(Clone, Copy, Debug)]
pub struct Car {
    /// l.
    pub wheel_base: f64,
}

impl ChainedVehicle<4> for Car {
    fn chained(&self, &[x, y, theta, phi]: &[f64; 4]) -> ChainedState<4> {
        let z2 = phi.tan() / (self.wheel_base * theta.cos().powi(3));
        ChainedState([x, z2, theta.tan(), y])
    }

    fn configuration(&self, &ChainedState([x, z2, z3, y]): &ChainedState<4>) -> [f64; 4] {
        let theta = z3.atan();
        [x, y, theta, (z2 * self.wheel_base * theta.cos().powi(3)).atan()]
    }

    fn slopes(&self, &[_, _, theta, phi]: &[f64; 4]) -> [f64; 4] {
        let u = 1.0 / theta.cos();
        [u * theta.cos(), u * theta.sin(), u * phi.tan() / self.wheel_base, 0.0]
    }
}

/// A car with a trailer: (x, y, θ, β, φ), where (x, y, θ) is the trailer's.
///
/// tan θ = dy/dx; its slope is tan β / (d cos³θ); the slope of that is
/// ((tan φ / (l cos β cos θ) - tan β / (d cos θ)) / cos²β + 3 tan²β tan θ / (d cos θ)) / (d cos³θ).
#[derive(Clone, Copy, Debug)]
pub struct CarWithTrailer {
    /// l.
    pub wheel_base: f64,
    /// d.
    pub drawbar: f64,
}

impl CarWithTrailer {
    /// What of z2 does not come from φ, and the factor of tan φ in the rest.
    fn slope_terms(&self, theta: f64, beta: f64) -> (f64, f64) {
        let (l, d, cos) = (self.wheel_base, self.drawbar, theta.cos());
        let scale = 1.0 / (d * cos.powi(3));
        let bend = 1.0 / beta.cos().powi(2);
        let drift =
            -beta.tan() / (d * cos) * bend + 3.0 * beta.tan().powi(2) * theta.tan() / (d * cos);
        (scale * drift, scale * bend / (l * beta.cos() * cos))
    }
}

impl ChainedVehicle<5> for CarWithTrailer {
    fn chained(&self, &[x, y, theta, beta, phi]: &[f64; 5]) -> ChainedState<5> {
        let (drift, gain) = self.slope_terms(theta, beta);
        let z3 = beta.tan() / (self.drawbar * theta.cos().powi(3));
        ChainedState([x, drift + gain * phi.tan(), z3, theta.tan(), y])
    }

    fn configuration(&self, &ChainedState([x, z2, z3, z4, y]): &ChainedState<5>) -> [f64; 5] {
        let theta = z4.atan();
        let beta = (z3 * self.drawbar * theta.cos().powi(3)).atan();
        let (drift, gain) = self.slope_terms(theta, beta);
        [x, y, theta, beta, ((z2 - drift) / gain).atan()]
    }

    fn slopes(&self, &[_, _, theta, beta, phi]: &[f64; 5]) -> [f64; 5] {
        // The trailer's axle goes at u cos β.
        let u = 1.0 / (theta.cos() * beta.cos());
        let trailer = u * beta.sin() / self.drawbar;
        let car = u * phi.tan() / self.wheel_base;
        [1.0, theta.tan(), trailer, car - trailer, 0.0]
    }
}

/// Steps of the integration in one interval.
const STEPS: usize = 2000;

/// Steers `vehicle` from one configuration to another in intervals of `epsilon` seconds and lets
/// `see` look at time, s, and configuration; returns where it really ends.
///
/// # Errors
/// [`CosineSwitchError`] if x does not change.
pub fn steer<const N: usize>(
    vehicle: &impl ChainedVehicle<N>,
    [start, end]: [&[f64; N]; 2],
    epsilon: f64,
    mut see: impl FnMut(f64, &[f64; N]),
) -> Result<[f64; N], CosineSwitchError> {
    let z = vehicle.chained(start);
    let switch = CosineSwitch::between(&z, &vehicle.chained(end), epsilon)?;
    let mut real = *start;
    let steps = (2 * (N - 2) + 1) * STEPS;
    let h = switch.duration() / steps as f64;
    for step in 0..steps {
        let t = step as f64 * h;
        see(t, &real);
        // The middle of the step: second order.
        let (v1, _) = switch.input(t + h / 2.0);
        real[N - 1] = vehicle.configuration(&switch.state_at(&z, t + h / 2.0))[N - 1];
        let half = moved(&real, &vehicle.slopes(&real), v1 * h / 2.0);
        real = moved(&real, &vehicle.slopes(&half), v1 * h);
    }
    real[N - 1] = vehicle.configuration(&switch.state_at(&z, switch.duration()))[N - 1];
    see(switch.duration(), &real);
    Ok(real)
}

fn moved<const N: usize>(from: &[f64; N], slopes: &[f64; N], by: f64) -> [f64; N] {
    std::array::from_fn(|place| from[place] + slopes[place] * by)
}
