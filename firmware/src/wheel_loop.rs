//! One wheel's velocity loop: wanted speed and encoder count in, motor duty out, 200 times a second.
//!
//! duty = feed-forward + k_v (ω_ref - ω) + k_i ∫(ω_ref - ω) dt. The integral is taken over encoder
//! counts, so it *is* the angle by which the wheel lags behind: nothing is lost to the coarse speed
//! measurement, and at rest the wheel stands where it should. The angle is clamped, so a blocked
//! wheel neither winds up nor jumps when it comes free.
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ω_ref, ω | wanted and measured speed of the wheel | rad/s |
//! | θ_ref - θ | angle by which it lags behind | rad |
//! | ω0 | no-load speed at full duty | rad/s |
//! | τ | time constant of the motor | s |

use protocol::motion::TICK;

/// How the loop answers; the same for both wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelLoopGains {
    /// ω0, rad/s.
    pub no_load_speed: f32,
    /// τ, s.
    pub time_constant: f32,
    /// The duty at which a resting wheel begins to turn.
    pub breakaway_duty: f32,
    /// k_v, duty per rad/s.
    pub velocity_gain: f32,
    /// k_i, duty per rad.
    pub angle_gain: f32,
}

impl Default for WheelLoopGains {
    /// For ω0 = 18 rad/s and τ = 60 ms: a closed loop of 30 rad/s, critically damped,
    /// τ s² + (1 + ω0 k_v) s + ω0 k_i = τ (s + 30)².
    fn default() -> Self {
        Self {
            no_load_speed: 18.0,
            time_constant: 0.06,
            breakaway_duty: 0.03,
            velocity_gain: 0.144,
            angle_gain: 3.0,
        }
    }
}

/// The lag at which the wheel counts as blocked, radians: 14 mm of a 35 mm wheel's rim.
const LARGEST_LAG: f32 = 0.4;

/// Ticks over which the speed is measured: one count more or less is then 0.2 rad/s.
const SPEED_TICKS: usize = 4;

/// Wanted speeds below this are rest: friction is not compensated there, rad/s.
const REST_SPEED: f32 = 0.02;

/// What one wheel's loop remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelLoop {
    count: i32,
    recent: [i32; SPEED_TICKS],
    lag: f32,
    wanted: f32,
    blocked_ticks: u32,
}

impl WheelLoop {
    /// A resting wheel whose encoder stands at `count`.
    pub fn new(count: i32) -> Self {
        Self { count, recent: [count; SPEED_TICKS], lag: 0.0, wanted: 0.0, blocked_ticks: 0 }
    }

    /// The wheel's measured speed, rad/s.
    pub fn speed(&self, radians_per_count: f32) -> f32 {
        let oldest = self.recent.first().copied().unwrap_or(self.count);
        let counts = self.count.wrapping_sub(oldest);
        counts as f32 * radians_per_count / (SPEED_TICKS as f32 * TICK.0)
    }

    /// How many ticks on end the wheel has lagged as far as it may.
    pub fn blocked_ticks(&self) -> u32 {
        self.blocked_ticks
    }

    /// One tick: the duty in -1..=1 for `wanted` rad/s, with the encoder at `count`.
    pub fn tick(
        &mut self,
        wanted: f32,
        count: i32,
        radians_per_count: f32,
        gains: &WheelLoopGains,
    ) -> f32 {
        let moved = count.wrapping_sub(self.count) as f32 * radians_per_count;
        self.recent.rotate_left(1);
        if let Some(newest) = self.recent.last_mut() {
            *newest = self.count;
        }
        self.count = count;
        // The speed wanted until now was to be reached in this tick; half of each tick counts.
        self.lag += (wanted + self.wanted) / 2.0 * TICK.0 - moved;
        let lag = self.lag.clamp(-LARGEST_LAG, LARGEST_LAG);
        self.blocked_ticks = if lag == self.lag { 0 } else { self.blocked_ticks + 1 };
        self.lag = lag;
        let acceleration = (wanted - self.wanted) / TICK.0;
        self.wanted = wanted;
        let feed_forward = (wanted + gains.time_constant * acceleration) / gains.no_load_speed
            + friction(wanted, gains);
        let error = wanted - self.speed(radians_per_count);
        (feed_forward + gains.velocity_gain * error + gains.angle_gain * lag).clamp(-1.0, 1.0)
    }
}

fn friction(wanted: f32, gains: &WheelLoopGains) -> f32 {
    if wanted.abs() < REST_SPEED { 0.0 } else { gains.breakaway_duty.copysign(wanted) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RADIANS_PER_COUNT: f32 = core::f32::consts::TAU / 1440.0;

    /// A motor of its own: τ ω̇ = ω0 duty - ω, with an encoder.
    fn run(ticks: usize, wanted: impl Fn(usize) -> f32, blocked: bool) -> (WheelLoop, f64, f64) {
        let gains = WheelLoopGains { breakaway_duty: 0.0, ..WheelLoopGains::default() };
        let mut wheel = WheelLoop::new(0);
        let (mut speed, mut angle, mut wanted_angle) = (0.0f64, 0.0f64, 0.0f64);
        for tick in 0..ticks {
            let count = (angle / f64::from(RADIANS_PER_COUNT)).floor() as i32;
            let duty = wheel.tick(wanted(tick), count, RADIANS_PER_COUNT, &gains);
            assert!(duty.abs() <= 1.0);
            for _ in 0..50 {
                speed += 1e-4 / 0.06 * (18.0 * f64::from(duty) - speed);
                angle += if blocked { 0.0 } else { speed * 1e-4 };
            }
            wanted_angle += f64::from(wanted(tick)) * 0.005;
        }
        (wheel, angle, wanted_angle)
    }

    #[test]
    fn a_wheel_follows_a_ramp_and_ends_where_it_should() {
        let profile = |tick: usize| match tick {
            0..100 => tick as f32 * 0.1,
            100..300 => 10.0,
            300..400 => (400 - tick) as f32 * 0.1,
            _ => 0.0,
        };
        let (wheel, angle, wanted) = run(600, profile, false);
        // One encoder count.
        assert!((angle - wanted).abs() <= 1.5 * f64::from(RADIANS_PER_COUNT), "{angle} {wanted}");
        assert_eq!(wheel.blocked_ticks(), 0);
    }

    #[test]
    fn a_blocked_wheel_is_noticed() {
        let (wheel, _, _) = run(100, |_| 5.0, true);
        // 0.4 rad at 5 rad/s: 16 ticks until the lag is full.
        assert!(wheel.blocked_ticks() > 80);
    }
}
