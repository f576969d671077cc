//! A tyre of some width on a hard floor: it grips, slips and scrubs.
//!
//! Every strip of the contact slides with its own velocity, because the inner edge of a wheel that
//! turns about the robot's middle has a shorter way than the outer one; each strip rubs against its own
//! slip with the same pressure. Over the width w that adds up to
//!
//! ```text
//! F_x = -μ_x N 2 s_x / (S₊ + S₋)          S± = sqrt((s_x ± r w/2)² + e²),  e² = s_y² + v_c²
//! F_y = -μ_y N s_y (asinh(a₊/e) - asinh(a₋/e)) / (r w)          a± = s_x ± r w/2
//! ```
//! and a moment that brakes the turn. Along and across share one grip: the force lies in an ellipse
//! with the axes μ_x N and μ_y N. While the robot spins without other drag, the moments of both
//! tyres vanish only if the rim is faster than the tyre's middle: as if the track were
//! b' = sqrt(b² + w²).
//!
//! | symbol | meaning | unit |
//! |---|---|---|
//! | s_x, s_y | slip of the contact's middle, along and across | m/s |
//! | v_c | slip at which rubber that is only stretched gives 71 % of its grip | m/s |
//! | N, μ | load, friction coefficient | N, – |
//! | r, w, b | yaw rate, width of the contact, track | rad/s, m, m |

/// What a tyre is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tyre {
    /// w, m.
    pub width: f64,
    /// μ along and across.
    pub grip: [f64; 2],
    /// v_c as a share of the rim's speed.
    pub creep: f64,
    /// v_c of a wheel that stands, m/s.
    pub least_creep: f64,
    /// Force against rolling as a share of the load.
    pub rolling_resistance: f64,
}

impl Tyre {
    /// One that rolls on a line without any slip to speak of: for comparison with formulas.
    pub const IDEAL: Self =
        Self { width: 0.0, grip: [1.0; 2], creep: 0.0, least_creep: 1e-9, rolling_resistance: 0.0 };

    /// Force over velocity along and across, N s/m, and moment over yaw rate, N m s, at this `slip`
    /// (s_x, s_y), yaw rate and speed of the rim. None is negative.
    pub(super) fn resistance(&self, load: f64, slip: [f64; 2], yaw: f64, rim: f64) -> [f64; 3] {
        let [s_x, s_y] = slip;
        let e = s_y.hypot(self.least_creep.max(self.creep * rim));
        let half = yaw * self.width / 2.0;
        let (inner, outer) = (s_x - half, s_x + half);
        let (near, far) = (inner.hypot(e), outer.hypot(e));
        let [along, across] = self.grip.map(|grip| grip * load);
        let middle = s_x.hypot(e);
        if half.abs() < 1e-4 * middle {
            // The strips differ by less than their own slip: first order in the width.
            let turn = self.width.powi(2) / 12.0 * e * e / middle.powi(3);
            return [along / middle, across / middle, along * turn];
        }
        let spread = ((outer / e).asinh() - (inner / e).asinh()) / (2.0 * half);
        // ∫ t (s_x - t) / sqrt(t² + e²) dt from the inner to the outer edge.
        let edge = |t: f64, root: f64| s_x * root - (t * root - e * e * (t / e).asinh()) / 2.0;
        let moment = (edge(outer, far) - edge(inner, near)) / (2.0 * half);
        [2.0 * along / (near + far), across * spread, (-along * moment / yaw.powi(2)).max(0.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TYRE: Tyre = Tyre {
        width: 0.02,
        grip: [0.8, 0.6],
        creep: 0.0,
        least_creep: 1e-3,
        rolling_resistance: 0.0,
    };

    /// Forces and moment by adding up 20 000 strips.
    fn strips([s_x, s_y]: [f64; 2], yaw: f64) -> [f64; 3] {
        let count = 20_000;
        let mut sum = [0.0; 3];
        for strip in 0..count {
            let place = TYRE.width * ((f64::from(strip) + 0.5) / f64::from(count) - 0.5);
            let along = s_x - yaw * place;
            let slip = (along * along + s_y * s_y + TYRE.least_creep.powi(2)).sqrt();
            let share = 5.0 / f64::from(count);
            let force = -TYRE.grip[0] * share * along / slip;
            sum[0] += force;
            sum[1] -= TYRE.grip[1] * share * s_y / slip;
            sum[2] -= place * force;
        }
        sum
    }

    #[test]
    fn the_formulas_are_the_sum_over_the_strips() {
        let mut random = fastrand::Rng::with_seed(3);
        for _ in 0..60 {
            let mut draw = |scale: f64| {
                let size = scale * 10f64.powf(-3.0 * random.f64());
                if random.bool() { size } else { -size }
            };
            let (slip, yaw) = ([draw(0.1), draw(0.05)], draw(10.0));
            let [c_x, c_y, c_r] = TYRE.resistance(5.0, slip, yaw, 0.3);
            let ours = [-c_x * slip[0], -c_y * slip[1], -c_r * yaw];
            let scales = [4.0, 3.0, 0.8 * 5.0 * 0.005];
            for ((a, b), scale) in ours.iter().zip(strips(slip, yaw)).zip(scales) {
                assert!((a - b).abs() < 1e-5 * scale, "{slip:?} {yaw}: {a} {b}");
            }
        }
    }

    #[test]
    fn the_force_stays_in_the_ellipse() {
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..1000 {
            let slip = [random.f64() - 0.5, random.f64() - 0.5];
            let [c_x, c_y, _] = TYRE.resistance(5.0, slip, 6.0 * random.f64() - 3.0, 0.1);
            let along = c_x * slip[0] / (0.8 * 5.0);
            let across = c_y * slip[1] / (0.6 * 5.0);
            assert!(along.hypot(across) <= 1.0 + 1e-9, "{slip:?}");
        }
    }
}
