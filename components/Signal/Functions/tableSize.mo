within Signal.Functions;
function tableSize "Rows and columns of a table in a file"
  input String fileName "File: CSV, or Modelica's text format for tables";
  input String tableName = "" "Name of the table in the text format; empty: the first";
  output Integer size[2] "Rows, columns";
external "C" bramah_table_size(fileName, tableName, size);
  annotation(Documentation(info = "<html><p>See <code>readTable</code>.</p></html>"));
end tableSize;
