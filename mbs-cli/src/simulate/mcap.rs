//! The motion as an MCAP recording, for viewers of robots' logs: the table's rows as messages, and where bodies are.
//!
//! Messages are JSON: `/motion` has the columns of the table, `/tf` the frames of bodies as `foxglove.FrameTransforms`.
//! Times count from the first row.
//!
//! Sources: Foxglove, *MCAP file format specification*, version 0; Foxglove, *FrameTransforms schema*.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::WriteOptions;
use mcap::records::MessageHeader;
use serde_json::{Map, Value, json};

use super::motion::Motion;
use crate::failure::Failure;
use crate::scene::{Body, Sight};

/// The file: `sights` are those of the motion's rows; with units the names of the columns end in them.
pub(crate) fn recording(motion: &Motion, sights: &[Sight], units: bool) -> Result<Vec<u8>, Failure> {
    written(motion, sights, units).map_err(|error| Failure::new(format_args!("cannot write MCAP: {error}")))
}

fn written(motion: &Motion, sights: &[Sight], units: bool) -> mcap::McapResult<Vec<u8>> {
    let names: Vec<String> = ["t".to_string()]
        .into_iter()
        .chain(motion.columns.iter().map(|column| if units { column.name_with_unit() } else { column.name.clone() }))
        .collect();
    let options = WriteOptions::new().compression(None).library(format!("mbs {}", env!("CARGO_PKG_VERSION")));
    let mut writer = options.create(Cursor::new(Vec::new()))?;
    let mut channel = |topic: &str, name: &str, schema: &Value| {
        let schema = writer.add_schema(name, "jsonschema", schema.to_string().as_bytes())?;
        writer.add_channel(schema, topic, "json", &BTreeMap::new())
    };
    let rows = channel("/motion", &format!("mbs.{}", motion.name), &of_rows(&names))?;
    let frames = channel("/tf", "foxglove.FrameTransforms", &of_frames())?;
    let first = motion.rows.first().map_or(0.0, |row| row.t);
    for (number, (row, sight)) in motion.rows.iter().zip(sights).enumerate() {
        let nanoseconds = ((row.t - first) * 1e9).round() as u64;
        let values = [row.t].into_iter().chain(row.values.iter().copied()).map(Value::from);
        let message: Map<String, Value> = names.iter().cloned().zip(values).collect();
        let transforms: Vec<Value> =
            sight.bodies.iter().enumerate().map(|(body, at)| transform(body, at, nanoseconds)).collect();
        for (channel_id, message) in [(rows, Value::from(message)), (frames, json!({ "transforms": transforms }))] {
            let sequence = number as u32;
            let header = MessageHeader { channel_id, sequence, log_time: nanoseconds, publish_time: nanoseconds };
            writer.write_to_known_channel(&header, message.to_string().as_bytes())?;
        }
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// The frame at a body's mass centre, in the world.
fn transform(number: usize, body: &Body, nanoseconds: u64) -> Value {
    const SECOND: u64 = 1_000_000_000;
    let (centre, turn) = (body.centre, body.attitude);
    json!({
        "timestamp": { "sec": nanoseconds / SECOND, "nsec": nanoseconds % SECOND },
        "parent_frame_id": "world",
        "child_frame_id": format!("body {}", number + 1),
        "translation": { "x": centre.x, "y": centre.y, "z": centre.z },
        "rotation": { "x": turn.i, "y": turn.j, "z": turn.k, "w": turn.w },
    })
}

fn object(properties: Map<String, Value>) -> Value {
    json!({ "type": "object", "properties": properties })
}

fn of_numbers<'n>(names: impl IntoIterator<Item = &'n str>) -> Value {
    object(names.into_iter().map(|name| (name.to_string(), json!({ "type": "number" }))).collect())
}

fn of_rows(names: &[String]) -> Value {
    of_numbers(names.iter().map(String::as_str))
}

/// The schema of `foxglove.FrameTransforms`, as far as it is used.
fn of_frames() -> Value {
    let time = json!({
        "type": "object", "title": "time",
        "properties": { "sec": { "type": "integer", "minimum": 0 }, "nsec": { "type": "integer", "minimum": 0 } },
    });
    let name = json!({ "type": "string" });
    let properties = [
        ("timestamp", time),
        ("parent_frame_id", name.clone()),
        ("child_frame_id", name),
        ("translation", of_numbers(["x", "y", "z"])),
        ("rotation", of_numbers(["x", "y", "z", "w"])),
    ];
    let transform = object(properties.into_iter().map(|(name, schema)| (name.to_string(), schema)).collect());
    let transforms = json!({ "type": "array", "items": transform });
    object([("transforms".to_string(), transforms)].into_iter().collect())
}

#[cfg(test)]
mod tests {
    use nalgebra::{Matrix3, UnitQuaternion, Vector3};

    use super::super::column::Column;
    use super::super::motion::Row;
    use super::*;

    #[test]
    fn what_is_written_is_read() {
        let row = |t: f64| Row { t, kinetic: 0.0, potential: 0.0, values: vec![2.0 * t, f64::NAN] };
        let columns = vec![Column::new("coordinates", "x", "m"), Column::new("outputs", "y", "1")];
        let motion = Motion { name: "A".to_string(), columns, rows: vec![row(3.0), row(4.25)], stopped: None };
        let sight = |x: f64| {
            let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), std::f64::consts::PI);
            let body = Body { mass: 1.0, centre: Vector3::new(x, 0.0, 2.0), attitude, inertia: Matrix3::zeros() };
            Sight { bodies: vec![body], places: Vec::new(), shapes: Vec::new() }
        };
        let file = recording(&motion, &[sight(6.0), sight(8.5)], true).unwrap();
        let messages: Vec<_> = mcap::MessageStream::new(&file).unwrap().map(Result::unwrap).collect();
        let read = |number: usize| -> (&str, u64, Value) {
            let message = &messages[number];
            (&message.channel.topic, message.log_time, serde_json::from_slice(&message.data).unwrap())
        };
        assert_eq!(messages.len(), 4);
        assert_eq!(read(0), ("/motion", 0, json!({ "t": 3.0, "x_m": 6.0, "y": null })));
        assert_eq!(read(2), ("/motion", 1_250_000_000, json!({ "t": 4.25, "x_m": 8.5, "y": null })));
        let (topic, time, frames) = read(3);
        assert_eq!((topic, time), ("/tf", 1_250_000_000));
        let frame = &frames["transforms"][0];
        assert_eq!(frame["timestamp"], json!({ "sec": 1, "nsec": 250_000_000 }));
        assert_eq!(frame["translation"], json!({ "x": 8.5, "y": 0.0, "z": 2.0 }));
        assert!((frame["rotation"]["z"].as_f64().unwrap() - 1.0).abs() < 1e-15);
        let schema = messages[1].channel.schema.as_ref().unwrap();
        assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("foxglove.FrameTransforms", "jsonschema"));
    }
}
