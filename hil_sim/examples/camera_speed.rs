//! How long the simulated camera takes for a picture: `cargo run --release -p wmr-sim --example camera_speed`.

use std::time::Instant;
use wmr_sim::base::TruePose;
use wmr_sim::camera::{Camera, CameraFaults};
use wmr_sim::world::{Shape, World};

const PICTURES: u32 = 200;

fn main() {
    for size in [[640, 480], [1280, 960]] {
        let shapes = (0..6).map(|index| {
            let (x, y) = (0.3 + 0.5 * f64::from(index % 3), 0.3 + 0.7 * f64::from(index / 3));
            Shape::Rect([x, y, x + 0.2, y + 0.25])
        });
        let world = World {
            size: [2.0, 1.5],
            shapes: shapes.collect(),
            movers: Vec::new(),
            robot_radius: 0.075,
        };
        let mut camera = Camera::above(world.size, size);
        let mut times: Vec<_> = (0..PICTURES)
            .map(|number| {
                let angle = 0.05 * f64::from(number);
                let (sin, cos) = angle.sin_cos();
                let pose = TruePose { x: 1.0 + 0.6 * cos, y: 0.75 + 0.1 * sin, heading: angle };
                let stage = camera.look().stage(&world, pose);
                let began = Instant::now();
                camera.picture(&stage, &CameraFaults::default(), number.into());
                began.elapsed()
            })
            .collect();
        let first = times.remove(0);
        times.sort();
        let [median, most] = [times.len() / 2, times.len() - 1].map(|place| times[place]);
        println!("{size:?}: the first {first:.1?}, then {median:.2?}, at most {most:.2?}");
    }
}
