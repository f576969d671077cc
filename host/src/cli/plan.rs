//! `wmr plan`: the way from start to goal.

use super::args::PlanArgs;
use super::error::CliError;
use super::folder::{Folder, has_format, write_named};
use super::input::{self, Sight};
use super::output::Output;
use super::queries;
use super::run::count_of_legs;
use super::way::{self, MarginRule, PlannedWay};
use serde_json::json;

/// `wmr plan`.
pub(crate) fn run(args: &PlanArgs, output: Output) -> Result<(), CliError> {
    let input = input::read(
        &args.input,
        &args.vision,
        Sight {
            radius: args.way.radius,
            resolution: args.way.resolution,
            keep_steps: args.steps.is_some(),
            start: args.way.start,
        },
        output,
    )?;
    let asked = &args.way;
    if args.queries {
        let document = queries::answers(&input, asked)?;
        let text = serde_json::to_string_pretty(&document).unwrap_or_default();
        return output.result(&document, &text);
    }
    let way = way::find(&input, asked, MarginRule::AsAsked, output)?;
    if let Some(path) = &args.output {
        let text = format!("{}\n", json!(way.file));
        write_named(path, text.as_bytes(), "plan", |older| has_format(older, "wmr-plan/1"))?;
    }
    if let Some(folder) = &args.steps {
        let folder = Folder::create(folder)?;
        folder.input(&input, way.file.scene.robot_radius)?;
        folder.plan(&way)?;
        folder.index("A way of wmr")?;
    }
    output.result(&way.file, &describe_way(&way))
}

/// A way, for people.
pub(crate) fn describe_way(way: &PlannedWay) -> String {
    let file = &way.file;
    let mut text = format!(
        "{:.3} m in {}, {:.1} s; {:.0} mm from the robot's middle to the nearest obstacle or border\n",
        file.length,
        count_of_legs(file.legs.len()),
        file.duration,
        file.clearance * 1000.0
    );
    let origin = way::origin(&file.scene);
    for (index, point) in file.waypoints.iter().enumerate() {
        let (x, y) = (point.x + origin.x, point.y + origin.y);
        text += &format!("  {index}: ({x:.3}, {y:.3})\n");
    }
    text
}
