//! Plans a way among a triangle and a disc: `cargo run -p wmr --example plan_shapes`.

use wmr::geometry::Point;
use wmr::plan::{PlanOptions, plan};
use wmr::scene::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // As a person writes it by hand; `Scene::from_json` refuses what makes no sense.
    let scene = Scene::from_json(
        r#"{"format": "wmr-scene/2", "arena": {"width": 1.6, "height": 1.2}, "robot_radius": 0.075,
            "obstacles": [{"polygon": [[0.5, 0.3], [0.9, 0.5], [0.6, 0.8]]}, {"circle": [1.15, 0.75, 0.12]}]}"#,
    )?;
    let (start, goal) = (Point::new(0.2, 0.3), Point::new(1.4, 0.9));
    let way = plan(&scene, start, goal, &PlanOptions::default())?;
    println!("{:.3} m, {:.3} m clear of everything", way.length, way.clearance);
    for point in &way.waypoints {
        println!("  ({:.3}, {:.3})", point.x, point.y);
    }
    Ok(())
}
