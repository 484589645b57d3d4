use super::*;

fn bound(value: f64, label: &str) -> Bound {
    Bound { value, label: label.to_owned(), color: Color::Ink, always: true }
}

fn drawn(plot: &Plot, values: Vec<f32>) -> Vec<Shape> {
    let track = Track { name: String::new(), start: 0.0, step: 0.01, columns: vec![("c".to_owned(), values)] };
    let mut drawing = Drawing::new((620, 430));
    let area = Area { corner: (0.0, 0.0), size: (620.0, 430.0), em: 14.0, titled: true };
    draw(&mut drawing, area, plot, &[track]);
    drawing.shapes
}

/// Each label of a bound: its words and the heights between which they stand.
fn labels(shapes: &[Shape]) -> Vec<(String, f64, f64)> {
    let label = |shape: &Shape| match shape {
        Shape::Words { at, size, text, .. } if text.contains(": ") => Some((text.clone(), at.1 - 0.75 * size, at.1)),
        _ => None,
    };
    shapes.iter().filter_map(label).collect()
}

#[test]
fn thinning_keeps_every_columns_extremes_and_the_end() {
    let mut points: Vec<Point> = (0..100_000).map(|i| (f64::from(i) * 5e-3, 100.0)).collect();
    points[50_000].1 = 7.0;
    points[50_001].1 = 193.0;
    let kept = thinned(&points);
    assert!(kept.len() <= 10, "{}", kept.len());
    for point in [points[0], points[50_000], points[50_001], points[99_999]] {
        assert!(kept.contains(&point), "{point:?}");
    }
    assert!(kept.windows(2).all(|pair| pair[0].0 < pair[1].0));
}

#[test]
fn labels_stand_beside_the_lines_of_bounds_and_apart() {
    // At both ends of the axis, close together, on both sides of zero, and where a line is that no curve comes near.
    for values in [vec![6.0, 3.5, 3.51], vec![0.0, 40.0], vec![1.0, -1.0, 0.4, -0.4], vec![0.29, -0.29, 0.33, -0.33]] {
        let bounds = values.iter().enumerate().map(|(place, value)| bound(*value, &format!("b{}", place / 2)));
        let plot = Plot::new("", "N", vec![Curve::new("c", "c", Color::Blue)]).within(bounds.collect());
        let shapes = drawn(&plot, vec![0.1, 0.2, 0.1]);
        let lines: Vec<f64> = shapes
            .iter()
            .filter_map(|shape| match shape {
                Shape::Stroke { points, line: LinePattern::Dashed, .. } => Some(points[0].1),
                _ => None,
            })
            .collect();
        assert_eq!(lines.len(), values.len());
        let labels = labels(&shapes);
        assert!(!labels.is_empty());
        for (text, top, bottom) in &labels {
            let struck = lines.iter().any(|line| (*top..=*bottom).contains(line));
            assert!(!struck, "{text}: from {top} to {bottom}, lines at {lines:?}");
        }
    }
}

#[test]
fn axes_have_units_and_zero_is_a_line_of_its_own() {
    let plot = Plot::new("Thrust", "N", vec![Curve::new("c", "thrust", Color::Blue)]).from_zero();
    let shapes = drawn(&plot, vec![4.0, 5.0]);
    let words: Vec<&str> = shapes
        .iter()
        .filter_map(|shape| if let Shape::Words { text, .. } = shape { Some(text.as_str()) } else { None })
        .collect();
    for word in ["Thrust", "thrust", "N", "s", "0"] {
        assert!(words.contains(&word), "{word}: {words:?}");
    }
    let strong = |shape: &&Shape| matches!(shape, Shape::Stroke { color: Color::Axis, points, .. } if points[0].1 == points[1].1);
    assert_eq!(shapes.iter().filter(strong).count(), 2, "zero and the axis of time");
}

#[test]
fn a_gap_in_the_numbers_is_a_gap_in_the_curve_and_words_stay_words() {
    let attack = "<script>\"'&";
    let plot = Plot::new(attack, attack, vec![Curve::new("c", attack, Color::Blue)]).within(vec![bound(1.0, attack)]);
    let shapes = drawn(&plot, vec![1.0, 2.0, f32::NAN, 1.0, f32::INFINITY]);
    let curves = |shape: &&Shape| matches!(shape, Shape::Stroke { color: Color::Blue, .. });
    assert_eq!(shapes.iter().filter(curves).count(), 3, "the legend and two parts");
    let svg = picture(&plot, &[Track::default()]);
    assert!(!svg.contains("<script") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
}
