//! One number for the shape of all messages: both ends must have the same for the robot to move.
//!
//! `schema.txt` beside this file lists every type on the wire, in the form that serde sees; a test
//! draws it again from the types and fails if it differs. Its hash is taken at compile time, so no
//! byte of it is in the firmware.

/// FNV-1a of `schema.txt`.
pub const SCHEMA_HASH: u64 = fnv_1a(include_str!("schema.txt").as_bytes());

const fn fnv_1a(mut bytes: &[u8]) -> u64 {
    let mut hash: u64 = 0xCBF2_9CE4_8422_2325;
    while let [byte, rest @ ..] = bytes {
        hash = (hash ^ *byte as u64).wrapping_mul(0x0000_0100_0000_01B3);
        bytes = rest;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::Header;
    use crate::message::{Command, Report};
    use serde_reflection::{ContainerFormat, Named, Samples, Tracer, TracerConfig, VariantFormat};
    use std::fmt::Write;

    #[test]
    fn the_check_values_of_fnv_1a() {
        assert_eq!(fnv_1a(b""), 0xCBF2_9CE4_8422_2325);
        assert_eq!(fnv_1a(b"foobar"), 0x8594_4171_F739_67E8);
    }

    #[test]
    fn the_list_is_that_of_the_types() {
        let drawn = draw();
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/schema.txt");
        if std::env::var_os("UPDATE_GOLDEN").is_some() {
            std::fs::write(path, &drawn).unwrap();
        }
        let listed = std::fs::read_to_string(path).unwrap();
        assert!(
            drawn == listed,
            "the types have changed; UPDATE_GOLDEN=1 cargo test -p wmr-protocol rewrites {path}"
        );
    }

    fn draw() -> String {
        let mut tracer = Tracer::new(TracerConfig::default());
        let samples = Samples::new();
        tracer.trace_type::<Header>(&samples).unwrap();
        tracer.trace_type::<Command>(&samples).unwrap();
        tracer.trace_type::<Report>(&samples).unwrap();
        // Enums inside others need to be asked for by themselves, so that every variant is seen.
        tracer.trace_type::<crate::message::Placement>(&samples).unwrap();
        tracer.trace_type::<crate::message::Reboot>(&samples).unwrap();
        tracer.trace_type::<crate::message::Wheel>(&samples).unwrap();
        tracer.trace_type::<crate::message::Board>(&samples).unwrap();
        tracer.trace_type::<crate::message::ResetCause>(&samples).unwrap();
        tracer.trace_type::<crate::message::State>(&samples).unwrap();
        tracer.trace_type::<crate::message::PauseReason>(&samples).unwrap();
        tracer.trace_type::<crate::message::Fault>(&samples).unwrap();
        tracer.trace_type::<crate::message::PlanRefusal>(&samples).unwrap();
        tracer.trace_type::<crate::message::PoseRefusal>(&samples).unwrap();
        tracer.trace_type::<crate::message::BatteryLevel>(&samples).unwrap();
        tracer.trace_type::<crate::parameters::ParameterRefusal>(&samples).unwrap();
        tracer.trace_type::<crate::motion::Refusal>(&samples).unwrap();
        tracer.trace_type::<crate::motion::Direction>(&samples).unwrap();
        tracer.trace_type::<crate::motion::Timing>(&samples).unwrap();
        let mut text = String::new();
        for (name, format) in tracer.registry().unwrap() {
            write!(text, "{name}").unwrap();
            container(&mut text, &format);
        }
        text
    }

    fn container(text: &mut String, format: &ContainerFormat) {
        match format {
            ContainerFormat::UnitStruct => writeln!(text, " = ()").unwrap(),
            ContainerFormat::NewTypeStruct(inner) => writeln!(text, " = {inner:?}").unwrap(),
            ContainerFormat::TupleStruct(inner) => writeln!(text, " = {inner:?}").unwrap(),
            ContainerFormat::Struct(fields) => {
                writeln!(text, " = struct").unwrap();
                list(text, fields, "  ");
            }
            ContainerFormat::Enum(variants) => {
                writeln!(text, " = enum").unwrap();
                for (tag, Named { name, value }) in variants {
                    write!(text, "  {tag} {name}").unwrap();
                    variant(text, value);
                }
            }
        }
    }

    fn variant(text: &mut String, format: &VariantFormat) {
        match format {
            VariantFormat::NewType(inner) => writeln!(text, " {inner:?}").unwrap(),
            VariantFormat::Struct(fields) => {
                writeln!(text).unwrap();
                list(text, fields, "      ");
            }
            VariantFormat::Unit => writeln!(text).unwrap(),
            other => writeln!(text, " {other:?}").unwrap(),
        }
    }

    fn list(text: &mut String, fields: &[Named<serde_reflection::Format>], indent: &str) {
        for Named { name, value } in fields {
            writeln!(text, "{indent}{name}: {value:?}").unwrap();
        }
    }
}
