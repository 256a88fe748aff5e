within Signal.Functions;
function readTable "Table from a file"
  input String fileName "File: CSV, or Modelica's text format for tables";
  input String tableName = "" "Name of the table in the text format; empty: the first";
  input Integer axes(min = 0, max = 2) = 1 "Must increase: 0 the first column, equal values allowed (times), 1 the first column, 2 first column and first row";
  input Integer m "Rows, from tableSize";
  input Integer n "Columns, from tableSize";
  output Real table[m, n] "The table";
external "C" bramah_table_read(fileName, tableName, axes, m, n, table);
  annotation(Documentation(info = "<html><p>Reads a table before the run. A relative name begins at the folder of the model's file, or else where the command runs; <code>modelica://Package/...</code> begins at the folder of a package.</p>
<p><b>CSV</b>: rows of numbers parted by comma, semicolon or tab, with or without a row of names above; lines that begin with <code>#</code> are remarks; the corner of a map may hold any word. <b>Text format</b>: <code>#1</code> in the first line, then tables, each headed by a line such as <code>double curve(3, 2)</code>: name, rows, columns; remarks begin with <code>#</code>. Numbers that do not increase where they must, missing numbers and words are told with their place in the file.</p>
<p>Bramah carries the two functions out itself. Other tools need the C functions of these names.</p></html>"));
end readTable;
