//! Test benches in SystemVerilog, made from a sheet: they drive a module with a vector file and write what it answers.
//!
//! `+in=FILE` is the vector file, `+out=FILE` where answers go (none without it). Each line is also compared; the bench ends with the
//! count of lines that differ. A bench that writes no answers fails where lines differ; one that does leaves the judgement to who
//! reads them. Vectors of another unit or format are refused. Tables are read from the folder in which the simulation runs.

use crate::expression::ExpressionError;
use crate::file::{format_line, unit_line};
use crate::{LineField, Sheet, UnitFormat};
use std::fmt::Write;

/// Words that a bench can hold.
pub const MOST_WORDS: usize = 1 << 22;
/// Lines of a vector file's header before the one that counts its lines, and characters of one that a bench can hold.
const COUNT_LINE: usize = 5;
const HEADER_CHARACTERS: usize = 512;

/// The name of a unit's bench.
pub fn name(sheet: &Sheet) -> String {
    format!("cube3_{}_tb", sheet.name.replace('-', "_"))
}

/// The text of a unit's bench for a format.
///
/// # Errors
/// An expression of the sheet without a value.
pub fn text(sheet: &Sheet, format: &UnitFormat) -> Result<String, ExpressionError> {
    let fields = [Sheet::fields(&sheet.inputs, format)?, Sheet::fields(&sheet.outputs, format)?];
    let [inputs, outputs] = &fields;
    let (module, further) = sheet.rtl();
    let bench = name(sheet);
    let counted = if sheet.clocked { "cycles" } else { "transactions" };
    let widest = inputs.iter().chain(outputs).map(|field| field.bits).max().unwrap_or(1);
    let (count_in, count) = (inputs.len(), inputs.len() + outputs.len());
    let bits = |fields: &[LineField], port: usize| -> u32 {
        fields.iter().filter(|field| field.port == port).map(|field| field.bits).sum()
    };
    let mut t = String::new();
    let _ = writeln!(
        t,
        "// Test bench of {module} for the vectors of the unit {}, made from its data sheet by",
        sheet.name
    );
    let _ = writeln!(
        t,
        "// cube3 vectors --unit {} --testbench. +in=FILE: vectors; +out=FILE: where the answers go.
// Without +out it fails where lines differ; with it, who reads the answers judges them.",
        sheet.name
    );
    let _ = writeln!(t, "module {bench};");
    let _ = writeln!(t, "    localparam integer FIELDS = {count};\n    localparam integer WORDS = {MOST_WORDS};\n");
    for (port, of) in sheet.inputs.iter().enumerate() {
        let _ = writeln!(t, "    reg [{}:0] {};", bits(inputs, port) - 1, of.name);
    }
    for (port, of) in sheet.outputs.iter().enumerate() {
        let width = bits(outputs, port) - 1;
        let _ = writeln!(t, "    wire [{width}:0] {};\n    reg [{width}:0] expected_{};", of.name, of.name);
    }
    let _ = writeln!(t, "\n    reg [{}:0] words [0:WORDS-1];", widest - 1);
    let _ = writeln!(t, "    reg [8*250-1:0] path;");
    let _ = writeln!(t, "    reg [8*{HEADER_CHARACTERS}-1:0] header;");
    let _ = writeln!(t, "    integer file, answers, at, lines, line, differ;\n    reg fits;");
    if sheet.clocked {
        let _ = writeln!(t, "    reg clk, rst;");
    }
    let _ = writeln!(t, "    reg drive;");
    let mut parameters: Vec<String> = format
        .settings()
        .into_iter()
        .filter(|(name, _)| sheet.parameters.contains(name))
        .map(|(name, value)| format!(".{}({value})", name.to_uppercase()))
        .collect();
    if !further.is_empty() {
        parameters.push(further.to_owned());
    }
    for table in &sheet.tables {
        parameters.push(format!(".{}_FILE(\"{}.{}.hex\")", table.name.to_uppercase(), sheet.name, table.name));
    }
    let mut connections: Vec<String> = Vec::new();
    if sheet.clocked {
        connections.extend([".clk(clk)".into(), ".rst(rst)".into()]);
    }
    connections.extend(sheet.inputs.iter().chain(&sheet.outputs).map(|port| format!(".{0}({0})", port.name)));
    let _ = writeln!(
        t,
        "\n    {module} #({}) dut (\n        {}\n    );",
        parameters.join(", "),
        connections.join(",\n        ")
    );
    let place =
        |t: &mut String, prefix: &str, becomes: &str, fields: &[LineField], ports: &[crate::Port], first: usize| {
            let mut low = 0;
            for (i, field) in fields.iter().enumerate() {
                if i > 0 && fields[i - 1].port != field.port {
                    low = 0;
                }
                let name = ports[field.port].name;
                let high = field.bits - 1;
                let _ = writeln!(
                    t,
                    "            {prefix}{name}[{low} +: {}] {becomes} words[line * FIELDS + {}][{high}:0];",
                    field.bits,
                    first + i
                );
                low += field.bits;
            }
        };
    let _ = writeln!(t, "\n    always @(posedge drive) begin");
    place(&mut t, "", "<=", inputs, &sheet.inputs, 0);
    let _ = writeln!(t, "    end");
    let (unit_line, format_line) = (unit_line(sheet), format_line(sheet, format));
    let _ = writeln!(
        t,
        "
    initial begin
        lines = -1;
        drive = 0;
        if (!$value$plusargs(\"in=%s\", path)) begin
            $display(\"{bench}: +in=FILE is missing: the vectors\");
        end else begin
            file = $fopen(path, \"r\");
            fits = file != 0;
            for (at = 1; fits && at <= {COUNT_LINE}; at = at + 1) begin
                if ($fgets(header, file) == 0) fits = 0;
                else if (at == 2) fits = header == \"{unit_line}\\n\";
                else if (at == 3) fits = header == \"{format_line}\\n\";
            end
            if (!fits) $display(\"{bench}: %0s is no vector file with the lines\\n{unit_line}\\n{format_line}\", path);
            else begin
                if ($fscanf(file, \"// {counted} %d\", lines) != 1 || lines * FIELDS > WORDS) lines = -1;
                if (lines < 0) $display(\"{bench}: no vectors with at most %0d lines in %0s\", WORDS / FIELDS, path);
            end
        end
        if (lines < 0) $fatal(1, \"{bench}: nothing was compared\");
        else begin
        $readmemh(path, words, 0, lines * FIELDS - 1);
        answers = 0;
        if ($value$plusargs(\"out=%s\", path)) answers = $fopen(path, \"w\");
        differ = 0;"
    );
    if sheet.clocked {
        let _ = writeln!(t, "        rst = 1; clk = 0; #1 clk = 1; #1 clk = 0; rst = 0;");
    }
    let _ = writeln!(t, "        for (line = 0; line < lines; line = line + 1) begin");
    // Inputs change at the edge of `drive`.
    let _ = writeln!(t, "            #1 drive = 1; #1 drive = 0;");
    place(&mut t, "expected_", "=", outputs, &sheet.outputs, count_in);
    let _ = writeln!(t, "            #1;");
    let mut slices = Vec::new();
    let mut low = 0;
    for (i, field) in outputs.iter().enumerate() {
        if i > 0 && outputs[i - 1].port != field.port {
            low = 0;
        }
        slices.push(format!("{}[{low} +: {}]", sheet.outputs[field.port].name, field.bits));
        low += field.bits;
    }
    let pattern = vec!["%h"; slices.len()].join(" ");
    let _ = writeln!(
        t,
        "            if (answers != 0) $fwrite(answers, \"{pattern}\\n\",\n                {});",
        slices.join(",\n                ")
    );
    let names = |prefix: &str| {
        let names: Vec<String> = sheet.outputs.iter().map(|port| format!("{prefix}{}", port.name)).collect();
        names.join(", ")
    };
    let _ = writeln!(t, "            if ({{{}}} !== {{{}}}) begin", names(""), names("expected_"));
    let _ = writeln!(t, "                if (differ == 0) $display(\"{module}: line %0d differs first\", line);");
    let _ = writeln!(t, "                differ = differ + 1;\n            end");
    if sheet.clocked {
        let _ = writeln!(t, "            #1 clk = 1; #1 clk = 0;");
    }
    let _ = writeln!(t, "        end");
    let _ = writeln!(
        t,
        "        $display(\"{module}: %0d of %0d lines differ\", differ, lines);
        if (differ > 0 && answers == 0) $fatal(1, \"{module}: lines differ\");
        else begin
            if (answers != 0) $fclose(answers);
            $finish;
        end
        end
    end
endmodule"
    );
    Ok(t)
}
