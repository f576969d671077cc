//! Plans a way among boxes made in code: `cargo run -p wmr --example plan_boxes`.

use wmr::geometry::{Point, Rect};
use wmr::plan::{Inflation, PlanError, PlanOptions, plan};
use wmr::scene::Scene;

fn main() -> Result<(), PlanError> {
    // A room of 4 × 3 m with two tables; the robot is a disc of 15 cm radius.
    let mut room = Scene::new(4.0, 3.0);
    room.robot_radius = 0.15;
    room.obstacles.push(Rect::new(1.0, 0.0, 1.4, 1.9).into());
    room.obstacles.push(Rect::new(2.4, 1.0, 2.8, 3.0).into());
    let (start, goal) = (Point::new(0.4, 0.5), Point::new(3.6, 2.5));
    for inflation in [Inflation::Square, Inflation::Disc] {
        let options = PlanOptions { inflation: Some(inflation), ..PlanOptions::default() };
        let way = plan(&room, start, goal, &options)?;
        println!(
            "inflation by a {inflation:?}: {:.3} m, {:.3} m clear of everything",
            way.length, way.clearance
        );
        for point in &way.waypoints {
            println!("  ({:.3}, {:.3})", point.x, point.y);
        }
    }
    // An error says what a person needs to know.
    room.obstacles.push(Rect::new(1.0, 2.1, 1.4, 3.0).into());
    if let Err(error) = plan(&room, start, goal, &PlanOptions::default()) {
        println!("with a third table: {error}");
    }
    Ok(())
}
