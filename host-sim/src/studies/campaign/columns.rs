//! Columns of a campaign's rows.

use arrow_array::RecordBatch;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, UInt64Type};

/// A column of whole numbers.
pub fn counts(flown: &[RecordBatch], column: &str) -> Vec<u64> {
    let columns = flown.iter().filter_map(|batch| batch.column_by_name(column));
    columns.flat_map(|column| column.as_primitive::<UInt64Type>().values().to_vec()).collect()
}

/// A column of whole numbers; none in a row without one.
pub fn whole_numbers(flown: &[RecordBatch], column: &str) -> Vec<Option<u64>> {
    let columns = flown.iter().filter_map(|batch| batch.column_by_name(column));
    columns.flat_map(|column| column.as_primitive::<UInt64Type>().iter()).collect()
}

/// A column of numbers; infinite in a row without one.
pub fn floats(flown: &[RecordBatch], column: &str) -> Vec<f64> {
    let columns = flown.iter().filter_map(|batch| batch.column_by_name(column));
    let value = |value: Option<f64>| value.unwrap_or(f64::INFINITY);
    columns.flat_map(|column| column.as_primitive::<Float64Type>().iter().map(value).collect::<Vec<_>>()).collect()
}
