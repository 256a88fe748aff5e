//! model Press
//! E022 at 3: "is a package, not a model"
package Press
  constant Real g = 9.81;
end Press;
