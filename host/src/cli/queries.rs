//! `wmr plan --queries`: all the ways that an arena file asks for, in one arena prepared once.

use super::args::WayArgs;
use super::error::CliError;
use super::input::Input;
use super::way::{microseconds, plan_options, planner, with_radius};
use std::time::Instant;
use wmr::document::{BuildTiming, FoundWay, QueriesDocument, QueryAnswer};
use wmr::plan::PreparedArena;

/// Plans the queries of a scene; an answer or an error each, in their order.
pub(crate) fn answers(input: &Input, args: &WayArgs) -> Result<QueriesDocument, CliError> {
    let Input::Scene(scene) = input else {
        return Err(CliError::usage(
            "only an arena file lists queries",
            "give a wmr-arena/1 file, or --start and --goal",
        ));
    };
    let scene = with_radius(scene, args.radius);
    let margin = args.margin.unwrap_or(0.0);
    let options = plan_options(args, planner(args.planner), margin);
    let began = Instant::now();
    let mut arena = PreparedArena::new(&scene, &options)?;
    let build = microseconds(began);
    let answers = scene.queries.iter().map(|query| {
        let began = Instant::now();
        let answer = arena.plan(query.start, query.goal);
        let timing_us = microseconds(began);
        match answer {
            Ok(plan) => QueryAnswer::Found(FoundWay {
                length: plan.length,
                waypoints: plan.waypoints,
                timing_us,
            }),
            Err(error) => QueryAnswer::Failed(CliError::from(error).document()),
        }
    });
    Ok(QueriesDocument { queries: answers.collect(), timing_us: BuildTiming { build } })
}
