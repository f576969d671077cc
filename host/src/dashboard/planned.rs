//! Plans as a page shows them: the document of `wmr plan --json`, with a look ahead and the mini-matrix's
//! lines; and the steps that led to them.

use super::desk::{Look, SILENT};
use super::error::Failure;
use super::steps;
use crate::cli::args::WayArgs;
use crate::cli::error::CliError;
use crate::cli::way::{self, MarginRule, PlannedWay};
use serde_json::{Value, json};
use wmr::grid::UNITS_PER_METRE;
use wmr::legs::{DEFAULT_LIMITS, planned_poses};
use wmr::picture::vision::NamedPicture;
use wmr::scene::Scene;

/// So many moments of a plan are shown in advance.
const MOST_PREVIEWS: usize = 120;

/// Plans in `scene` as for a drive.
pub(super) fn plan(scene: &Scene, args: &WayArgs) -> Result<Box<PlannedWay>, CliError> {
    let planner = way::planner(args.planner);
    way::plan_way(scene, planner, args, MarginRule::ForDriving, SILENT).map(Box::new)
}

/// The document of `wmr plan --json`, with what that command would say beside it.
pub(super) fn plan_document(way: &PlannedWay, args: &WayArgs) -> Value {
    let mut document = json!(way.file);
    let legs = way::legs_of(&way.file, args, &DEFAULT_LIMITS);
    let poses = planned_poses(&legs, &DEFAULT_LIMITS);
    let every = poses.len().div_ceil(MOST_PREVIEWS).max(1);
    let preview: Vec<_> = poses.iter().step_by(every).chain(poses.last()).collect();
    if let Some(fields) = document.as_object_mut() {
        let exit_leg = way.plan.as_ref().and_then(|plan| plan.exit_leg);
        fields.insert("margin".into(), json!(way.options.margin));
        fields.insert("exit_leg".into(), json!(exit_leg));
        let preview = preview.iter().map(|(time, pose)| {
            let [x, y, heading] = <[f64; 3]>::from(*pose);
            let corner = way::origin(&way.file.scene);
            json!([time, x + corner.x, y + corner.y, heading])
        });
        fields.insert("preview".into(), preview.collect());
        fields.insert("grid_lines".into(), grid_lines(way));
    }
    document
}

/// Where the lines between the areas of the mini-matrix are, metres: across from the left, up from below.
fn grid_lines(way: &PlannedWay) -> Value {
    let stages = way.plan.as_ref().and_then(|plan| plan.grid.as_ref());
    let Some(stages) = stages else { return Value::Null };
    let matrix = way.file.mini_matrix.as_deref().unwrap_or_default();
    let corner = way::origin(&way.file.scene);
    // The matrix leaves out the dead ring along the border.
    let metres = |units: &[i32], areas: usize, from: f64| -> Vec<f64> {
        let ring = units.len().saturating_sub(areas + 1) / 2;
        let inner = units.iter().skip(ring).take(areas + 1);
        inner.map(|&unit| f64::from(unit) / UNITS_PER_METRE + from).collect()
    };
    let lines = stages.closed.lines();
    let columns = matrix.first().map_or(0, Vec::len);
    json!({
        "xs": metres(&lines.xs, columns, corner.x), "ys": metres(&lines.ys, matrix.len(), corner.y),
    })
}

/// The steps from the photo to the path, drawn.
pub(super) fn draw_steps(
    look: Option<&Look>,
    way: Option<&PlannedWay>,
    radius: f64,
) -> Result<Vec<NamedPicture>, Failure> {
    let seen = look.map(|look| look.see(true)).transpose()?;
    Ok(steps::pictures(seen.as_ref(), way, radius))
}
