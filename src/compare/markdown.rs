//! Tables in Markdown that read well as plain text too.

/// A row of a table.
pub type Row = Vec<String>;

/// A row of these cells.
pub fn row<const N: usize>(cells: [&str; N]) -> Row {
    cells.map(str::to_owned).to_vec()
}

/// A table whose first row is its heading; the first `words` columns hold words, the others numbers.
///
/// Columns are as wide as their widest cell, words stand left and numbers right. Bars and line ends in
/// cells are written such that the table stays whole; cells that a row lacks are empty.
pub fn table(rows: &[Row], words: usize) -> String {
    let columns = rows.first().map_or(0, Vec::len);
    let cell = |row: &[String], n: usize| row.get(n).map_or_else(String::new, |c| plain(c));
    let width = |n: usize| {
        let widths = rows.iter().map(|row| cell(row, n).chars().count());
        widths.max().unwrap_or(0).max(2)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &[String]| {
        let cells = widths
            .iter()
            .enumerate()
            .map(|(n, &width)| match n < words {
                true => format!("| {:<width$} ", cell(row, n)),
                false => format!("| {:>width$} ", cell(row, n)),
            });
        cells.collect::<String>() + "|\n"
    };
    let rule = widths.iter().enumerate().map(|(n, &width)| {
        let end = if n < words { '-' } else { ':' };
        format!("| {}{end} ", "-".repeat(width - 1))
    });
    let mut lines = rows.iter().map(|row| line(row));
    let heading = lines.next().unwrap_or_default();
    heading + &rule.collect::<String>() + "|\n" + &lines.collect::<String>()
}

fn plain(cell: &str) -> String {
    cell.replace('|', "\\|").replace(['\n', '\r'], " ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_as_wide_as_their_widest_cell() {
        let rows = [
            row(["case", "strategy", "ms"]),
            row(["A", "plts", "1234.5"]),
            row(["LÄNGER", "srg"]),
        ];
        let expected = "\
| case   | strategy |     ms |
| ------ | -------- | -----: |
| A      | plts     | 1234.5 |
| LÄNGER | srg      |        |
";
        assert_eq!(table(&rows, 2), expected);
        assert_ne!(table(&rows, 1), expected);
    }

    #[test]
    fn cells_cannot_break_the_table() {
        let rows = [row(["a"]), row(["x|y\nz"])];
        assert_eq!(table(&rows, 1), "| a      |\n| ------ |\n| x\\|y z |\n");
        assert_eq!(table(&[], 1), "|\n");
    }
}
