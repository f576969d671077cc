//! Draws what each stage of the flow saw, as SVG.
