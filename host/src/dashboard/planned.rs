//! Plans as a page shows them: the document of `wmr plan --json`, with a look ahead and the mini-matrix's
//! lines; and the steps that led to them.

use super::desk::{Desk, Look, SILENT};
use super::error::Failure;
use super::jobs::Going;
use super::requests::{DetectRequest, PlanRequest};
use super::steps;
use crate::cli::args::WayArgs;
use crate::cli::demo;
use crate::cli::error::CliError;
use crate::cli::way::{self, MarginRule, PlannedWay};
use serde_json::{Value, json};
use wmr::grid::{LatticePoint, UNITS_PER_METRE};
use wmr::legs::{DEFAULT_LIMITS, planned_poses};
use wmr::picture::vision::NamedPicture;
use wmr::plan::TreeNode;
use wmr::scene::Scene;

/// So many moments of a plan are shown in advance.
const MOST_PREVIEWS: usize = 120;
/// So many branches of the tree are shown: more only cover the floor.
const MOST_BRANCHES: usize = 600;

/// Plans in `scene` as for a drive.
pub(super) fn plan(scene: &Scene, args: &WayArgs) -> Result<Box<PlannedWay>, CliError> {
    let planner = way::planner(args.planner);
    way::plan_way(scene, planner, args, MarginRule::ForDriving, SILENT).map(Box::new)
}

/// Lays down what `wmr demo` sees and plans.
pub(super) fn lay_demo(desk: &mut Desk) -> Result<(), Failure> {
    desk.take_sample()?;
    let look = desk.look(&DetectRequest::default())?;
    desk.take_detection(&look, &look.see(false)?);
    let args = demo::way_args();
    let mut scene = desk.scene_for(&PlanRequest::default())?;
    way::take_ends(&mut scene, &args);
    let way = plan(&scene, &args)?;
    desk.take_plan(scene, (args, Ok(way)));
    Ok(())
}

/// The document of `wmr plan --json`, with what that command would say beside it.
pub(super) fn plan_document(way: &PlannedWay) -> Value {
    let mut document = json!(way.file);
    let legs = way.file.legs_for(&way.legs, &DEFAULT_LIMITS);
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
        fields.insert("tree".into(), tree(way));
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

/// The branches of the tree of global paths, each from entry point to entry point as x, y, x, y in metres.
fn tree(way: &PlannedWay) -> Value {
    let stages = way.plan.as_ref().and_then(|plan| plan.grid.as_ref());
    let Some(tree) = stages.and_then(|stages| stages.tree.as_ref()) else { return Value::Null };
    let corner = way::origin(&way.file.scene);
    let metres = |at: LatticePoint| {
        let metres = |units: i32, from: f64| f64::from(units) / UNITS_PER_METRE + from;
        [metres(at.x, corner.x), metres(at.y, corner.y)]
    };
    let branch = |node: &TreeNode| {
        let before = tree.nodes.get(node.parent)?;
        Some([metres(before.entry), metres(node.entry)].concat())
    };
    json!(tree.nodes.iter().skip(1).take(MOST_BRANCHES).filter_map(branch).collect::<Vec<_>>())
}

/// The steps from the photo to the path, drawn.
pub(super) fn draw_steps(
    look: Option<&Look>,
    way: Option<&PlannedWay>,
    radius: f64,
    going: &Going,
) -> Result<Vec<NamedPicture>, Failure> {
    let seen = look.map(|look| look.see(true)).transpose()?;
    going.check()?;
    Ok(steps::pictures(seen.as_ref(), way, radius))
}
