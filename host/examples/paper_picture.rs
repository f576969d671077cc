//! Draws the paper's experiment as a photo, `host/assets/paper.png`:
//! `cargo run -p host --example paper_picture > host/assets/paper.png`

use host::picture::overhead::overhead_png;
use host::scene::Scene;
use std::io::Write;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::from_json(include_str!("../assets/paper.json"))?;
    std::io::stdout().write_all(&overhead_png(&scene, 250.0)?)?;
    Ok(())
}
