//! TOML into the common tree.

use toml::de::{DeTable, DeValue};

use super::value::{Key, Lines, Node, SyntaxError, Value};

/// Reads a TOML document.
pub fn parse(text: &str) -> Result<Node, SyntaxError> {
    let lines = Lines::new(text);
    match DeTable::parse(text) {
        Ok(table) => Ok(Node {
            line: 1,
            value: convert_table(table.into_inner(), &lines),
        }),
        Err(error) => Err(SyntaxError {
            line: error.span().map_or(1, |s| lines.at(s.start)),
            message: error.message().lines().collect::<Vec<_>>().join(", "),
        }),
    }
}

fn convert_table(table: DeTable<'_>, lines: &Lines) -> Value {
    let mut entries: Vec<(usize, Key, Node)> = table
        .into_iter()
        .map(|(key, value)| {
            let start = key.span().start;
            let key = Key {
                line: lines.at(start),
                name: key.into_inner().into_owned(),
            };
            let line = lines.at(value.span().start);
            (
                start,
                key,
                Node {
                    line,
                    value: convert(value.into_inner(), lines),
                },
            )
        })
        .collect();
    entries.sort_by_key(|e| e.0);
    Value::Table(
        entries
            .into_iter()
            .map(|(_, key, node)| (key, node))
            .collect(),
    )
}

fn convert(value: DeValue<'_>, lines: &Lines) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.into_owned()),
        // Out of the range of i64 is still a number; f64 is what is needed in the end.
        DeValue::Integer(i) => {
            Value::Number(i64::from_str_radix(i.as_str(), i.radix()).map_or(f64::NAN, |i| i as f64))
        }
        DeValue::Float(x) => Value::Number(x.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(b) => Value::Bool(b),
        DeValue::Datetime(d) => Value::Text(d.to_string()),
        DeValue::Array(items) => Value::List(
            items
                .into_iter()
                .map(|item| Node {
                    line: lines.at(item.span().start),
                    value: convert(item.into_inner(), lines),
                })
                .collect(),
        ),
        DeValue::Table(table) => convert_table(table, lines),
    }
}
