//! One wheel's velocity loop: wanted speed and encoder count in, motor duty out, 200 times a second.
//!
//! duty = feed-forward + k_v (ω_ref - ω) + k_i ∫(ω_ref - ω) dt. The integral is taken over encoder
//! counts, so it *is* the angle by which the wheel lags behind: nothing is lost to the coarse speed
//! measurement, and at rest the wheel stands where it should. The angle is clamped, so a blocked
//! wheel neither winds up nor jumps when it comes free.
//!
//! The loop also knows best whether its wheel does what it should: see [`WheelLoop::fault`].
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | ω_ref, ω | wanted and measured speed of the wheel | rad/s |
//! | θ_ref - θ | angle by which it lags behind | rad |
//! | ω0 | no-load speed at full duty | rad/s |
//! | τ | time constant of the motor | s |

use crate::effort::Effort;
use protocol::message::Fault;
use protocol::motion::TICK;
use protocol::parameters::Parameters;

/// The lag at which the wheel counts as blocked, radians: 14 mm of a 35 mm wheel's rim.
const LARGEST_LAG: f32 = 0.4;

/// Ticks over which the speed is measured: one count more or less is then 0.2 rad/s.
const SPEED_TICKS: usize = 4;

/// Wanted speeds below this are rest: friction is not compensated there, rad/s.
const REST_SPEED: f32 = 0.02;

/// Wheels wanted slower than this are not watched: a count is then 9 ms or more, rad/s.
const SLOWEST_WATCHED: f32 = 0.5;

/// A wheel slower than this share of what is wanted stands.
const STANDING_SHARE: f32 = 0.2;

/// A wheel that stands for this long is stalled, ticks; with the 20 ms of the speed measurement and
/// a tick of delay the drive is cut 225 ms after the wheel stopped.
const STALLED_TICKS: u8 = 40;

/// A wheel that lags as far as it may for this long is stalled, even if it creeps, ticks.
const LAGGING_TICKS: u8 = 20;

/// A wheel that runs backwards faster than this, although driven forwards, has its encoder wired
/// backwards, rad/s; more than any recoil.
const BACKWARD_SPEED: f32 = 1.0;
/// Below this duty the wheel may be rolling against its drive.
const DRIVING_DUTY: f32 = 0.15;
/// For how long it must, ticks.
const BACKWARD_TICKS: u8 = 20;

/// An encoder without a count for so many ticks, on a wheel that should turn, stands or has no contact.
const DEAD_TICKS: u8 = 6;
/// In the second tick after that a motor, from standstill, has turned its wheel by ω0/τ · 1.5 ticks · 1 tick; more
/// than this many times as much was turned before, and not counted.
const JUMP_MARGIN: f32 = 2.5;

/// No motor turns a wheel by more than this many times its no-load speed, downhill included.
const LARGEST_OVERSPEED: f32 = 2.0;

/// A wheel's numbers in the form in which the loop multiplies by them, computed once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WheelModel {
    /// Angle of one encoder count, rad.
    radians_per_count: f32,
    /// Speed of one count in the window of the measurement, rad/s.
    speed_per_count: f32,
    /// 1/ω0, s/rad.
    duty_per_speed: f32,
    /// τ/ω0 over one tick, s/rad.
    duty_per_change: f32,
    /// k_v, s/rad.
    velocity_gain: f32,
    /// k_i, 1/rad.
    angle_gain: f32,
    breakaway_duty: f32,
    /// The most counts that a tick may bring.
    largest_leap: u32,
    /// And the most that the second tick after standstill may.
    largest_jump: u32,
}

impl From<&Parameters> for WheelModel {
    fn from(parameters: &Parameters) -> Self {
        let gains = &parameters.wheel_loop;
        let radians_per_count = parameters.radians_per_count();
        // The largest leap is one of a tick, and a late tick may have seen the way of four.
        let largest = 4.0 * LARGEST_OVERSPEED * gains.no_load_speed * TICK.0;
        let started = 1.5 * gains.no_load_speed / gains.time_constant * TICK.0 * TICK.0;
        Self {
            radians_per_count,
            speed_per_count: radians_per_count / (SPEED_TICKS as f32 * TICK.0),
            duty_per_speed: 1.0 / gains.no_load_speed,
            duty_per_change: gains.time_constant / gains.no_load_speed / TICK.0,
            velocity_gain: gains.velocity_gain,
            angle_gain: gains.angle_gain,
            breakaway_duty: gains.breakaway_duty,
            largest_leap: (largest / radians_per_count) as u32,
            largest_jump: (JUMP_MARGIN * started / radians_per_count) as u32,
        }
    }
}

/// What one wheel's loop remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WheelLoop {
    count: i32,
    recent: [i32; SPEED_TICKS],
    lag: f32,
    wanted: f32,
    lagging_ticks: u8,
    standing_ticks: u8,
    backward_ticks: u8,
    leapt: bool,
    /// Ticks on end without a count, of a wheel that should turn.
    dead_ticks: u8,
    /// Whether the tick before was the first with a count after that.
    revived: bool,
    effort: Effort,
}

impl WheelLoop {
    /// A resting wheel whose encoder stands at `count`.
    pub(crate) fn new(count: i32) -> Self {
        Self {
            count,
            recent: [count; SPEED_TICKS],
            lag: 0.0,
            wanted: 0.0,
            lagging_ticks: 0,
            standing_ticks: 0,
            backward_ticks: 0,
            leapt: false,
            dead_ticks: 0,
            revived: false,
            effort: Effort::default(),
        }
    }

    /// The wheel's measured speed, rad/s.
    pub(crate) fn speed(&self, model: &WheelModel) -> f32 {
        let oldest = self.recent.first().copied().unwrap_or(self.count);
        self.count.wrapping_sub(oldest) as f32 * model.speed_per_count
    }

    /// What is wrong with the wheel, if anything: it stalls, or its encoder counts what cannot be.
    pub(crate) fn fault(&self) -> Option<Fault> {
        if self.leapt || self.backward_ticks >= BACKWARD_TICKS {
            Some(Fault::Encoder)
        } else if self.standing_ticks >= STALLED_TICKS || self.lagging_ticks >= LAGGING_TICKS {
            Some(Fault::Stall)
        } else {
            None
        }
    }

    /// One tick: the duty in -1..=1 for `wanted` rad/s, with the encoder at `count`.
    pub(crate) fn tick(&mut self, wanted: f32, count: i32, model: &WheelModel) -> f32 {
        let counts = count.wrapping_sub(self.count);
        self.recent.rotate_left(1);
        if let Some(newest) = self.recent.last_mut() {
            *newest = self.count;
        }
        self.count = count;
        self.leapt |= counts.unsigned_abs() > model.largest_leap;
        self.watch_contact(counts.unsigned_abs(), model);
        // The speed wanted until now was to be reached in this tick; half of each tick counts.
        let due = (wanted + self.wanted) * (TICK.0 / 2.0);
        self.lag += due - counts as f32 * model.radians_per_count;
        let lag = self.lag.clamp(-LARGEST_LAG, LARGEST_LAG);
        self.lagging_ticks = counted(lag != self.lag, self.lagging_ticks);
        self.lag = lag;
        let feed_forward = wanted * model.duty_per_speed
            + (wanted - self.wanted) * model.duty_per_change
            + model.friction(wanted);
        self.wanted = wanted;
        let speed = self.speed(model);
        let correction = model.velocity_gain * (wanted - speed) + model.angle_gain * lag;
        let duty = (feed_forward + correction).clamp(-1.0, 1.0);
        self.watch(speed, duty, feed_forward);
        duty
    }

    /// What it takes to turn it, against what its motor's model asks for.
    pub(crate) fn effort(&mut self) -> &mut Effort {
        &mut self.effort
    }

    /// An encoder that falls silent at speed and goes on at speed has lost its contact for that time, and the
    /// wheel's way with it: no wheel stops and starts so.
    fn watch_contact(&mut self, counts: u32, model: &WheelModel) {
        self.leapt |= self.revived && counts > model.largest_jump;
        self.revived = counts > 0 && self.dead_ticks >= DEAD_TICKS;
        self.dead_ticks =
            counted(counts == 0 && self.wanted.abs() > SLOWEST_WATCHED, self.dead_ticks);
    }

    fn watch(&mut self, speed: f32, duty: f32, feed_forward: f32) {
        let along = |value: f32| if self.wanted.is_sign_negative() { -value } else { value };
        let (ahead, drive, wanted) = (along(speed), along(duty), self.wanted.abs());
        let stands = wanted > SLOWEST_WATCHED && ahead < STANDING_SHARE * wanted;
        self.standing_ticks = counted(stands, self.standing_ticks);
        let backward = ahead < -BACKWARD_SPEED && drive > DRIVING_DUTY;
        self.backward_ticks = counted(backward, self.backward_ticks);
        self.effort.update(wanted, ahead, drive, along(feed_forward));
    }
}

impl WheelModel {
    fn friction(&self, wanted: f32) -> f32 {
        if wanted.abs() < REST_SPEED { 0.0 } else { self.breakaway_duty.copysign(wanted) }
    }
}

/// How many ticks on end something has been so.
fn counted(so: bool, ticks: u8) -> u8 {
    if so { ticks.saturating_add(1) } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use protocol::parameters::WheelLoopGains;

    const RADIANS_PER_COUNT: f32 = core::f32::consts::TAU / 1440.0;

    /// A motor of its own: τ ω̇ = ω0 duty - ω, with an encoder.
    fn run(ticks: usize, wanted: impl Fn(usize) -> f32, blocked: bool) -> (WheelLoop, f64, f64) {
        let wheel_loop = WheelLoopGains { breakaway_duty: 0.0, ..WheelLoopGains::default() };
        let model = WheelModel::from(&Parameters { wheel_loop, ..Parameters::default() });
        let mut wheel = WheelLoop::new(0);
        let (mut speed, mut angle, mut wanted_angle) = (0.0f64, 0.0f64, 0.0f64);
        for tick in 0..ticks {
            let count = (angle / f64::from(RADIANS_PER_COUNT)).floor() as i32;
            let duty = wheel.tick(wanted(tick), count, &model);
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
        assert_eq!(wheel.fault(), None);
    }

    #[test]
    fn a_blocked_wheel_is_noticed() {
        // 0.4 rad at 5 rad/s: 16 ticks until the lag is full, and 20 more.
        assert_eq!(run(34, |_| 5.0, true).0.fault(), None);
        assert_eq!(run(38, |_| 5.0, true).0.fault(), Some(Fault::Stall));
        // At 0.6 rad/s the lag fills in 0.7 s, but a standing wheel is seen in 45 ticks.
        assert_eq!(run(45, |_| 0.6, true).0.fault(), Some(Fault::Stall));
        assert_eq!(run(400, |_| 0.0, true).0.fault(), None);
    }

    #[test]
    fn an_impossible_encoder_is_noticed() {
        let model = WheelModel::from(&Parameters::default());
        let mut leaping = WheelLoop::new(0);
        leaping.tick(5.0, 8, &model);
        assert_eq!(leaping.fault(), None);
        leaping.tick(5.0, 1000, &model);
        assert_eq!(leaping.fault(), Some(Fault::Encoder));
        // No contact for 40 ms at 10 rad/s, 11.5 counts a tick; and a wheel that was held as long.
        for (starts, fault) in [([7, 11, 12], Some(Fault::Encoder)), ([1, 2, 4], None)] {
            let (mut wheel, mut count) = (WheelLoop::new(0), 0);
            for counts in [11, 12, 11, 12].into_iter().chain([0; 8]).chain(starts) {
                count += counts;
                wheel.tick(10.0, count, &model);
            }
            assert_eq!(wheel.fault(), fault, "{starts:?}");
        }
        // Swapped wires: 5 rad/s forwards count as 5.7 counts a tick backwards.
        let mut swapped = WheelLoop::new(0);
        for tick in 1..=26 {
            swapped.tick(5.0, -tick * 6, &model);
        }
        assert_eq!(swapped.fault(), Some(Fault::Encoder));
    }
}
