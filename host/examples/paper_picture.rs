//! Draws the paper's experiment as a photo, `host/assets/paper.png`:
//! `cargo run -p wmr --example paper_picture > host/assets/paper.png`

use std::io::Write;
use wmr::picture::overhead::overhead_png;
use wmr::scene::Scene;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::from_json(include_str!("../assets/paper.json"))?;
    std::io::stdout().write_all(&overhead_png(&scene, 250.0)?)?;
    Ok(())
}
